"""Wrappers of PettingZoo: robots that are always there, and masks inside the observation.

env = MaskedObservations(AllRobots(clean_swarm_v0.parallel_env(family="shifting", size=(10.0, 10.0))))
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from pettingzoo import ParallelEnv
from pettingzoo.utils.wrappers import BaseParallelWrapper

from clean_swarm_env.borders.infos import ALIVE, MASK, OPTION_MASK
from clean_swarm_env.clean_swarm_v0 import AgentAction, AgentInfos, AgentsStep, CleanSwarm
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.observer import Observations


class AllRobots(BaseParallelWrapper[str, Observations, AgentAction]):
    """All possible agents act in every step of an episode, also robots that join later or are gone.

    An observation has one component more, `alive`: 1 for a robot at work. Of other robots all components are 0, the
    reward is 0, and the action does nothing. All agents terminate or are truncated together, with the mission.
    """

    def __init__(self, env: CleanSwarm) -> None:
        super().__init__(env)
        self.env: CleanSwarm = env
        self.possible_agents = env.possible_agents
        self.agents: list[str] = []
        self.observation_names = (*env.observation_names, ALIVE)
        space = env.observation_space(env.possible_agents[0])
        low, high = np.append(space.low, np.float32(0.0)), np.append(space.high, np.float32(1.0))
        self._spaces = {agent: gymnasium.spaces.Box(low, high, dtype=np.float32) for agent in env.possible_agents}

    def observation_space(self, agent: str) -> gymnasium.spaces.Box:
        """Return the space of an agent's observations: always the same object."""
        return self._spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observations], AgentInfos]:
        """Begin an episode."""
        self.env.reset(seed=seed, options=options)
        self.agents = list(self.possible_agents)
        return self._seen()

    def step(self, actions: Mapping[str, AgentAction]) -> AgentsStep:
        """Run one decision period; `actions` has one for each possible agent."""
        acting = self.env.agents
        if isinstance(actions, Mapping) and actions.keys() == set(self.agents):
            actions = {agent: actions[agent] for agent in acting}
        _, rewards, _, truncations, _ = self.env.step(actions)
        everyone, over = self.agents, not self.env.agents
        cut = over and any(truncations.values())
        observations, infos = self._seen()
        if over:
            self.agents = []
        return (
            observations,
            {agent: rewards.get(agent, 0.0) for agent in everyone},
            dict.fromkeys(everyone, over and not cut),
            dict.fromkeys(everyone, cut),
            infos,
        )

    def _seen(self) -> tuple[dict[str, Observations], AgentInfos]:
        """Return the observations and infos of all robots."""
        observations, infos = self.env.seen(self.possible_agents)
        alive = [infos[agent][ALIVE] for agent in self.possible_agents]
        flagged = np.column_stack([np.stack([*observations.values()]), alive]).astype(np.float32)
        return dict(zip(self.possible_agents, flagged, strict=True)), infos


class MaskedObservations(BaseParallelWrapper[str, dict[str, NDArray[Any]], AgentAction]):
    """Observations are dictionaries: the observation, and `action_mask`, the options that can serve next (1 or 0).

    Where an action is more than one option, the key is `option_mask`: libraries sample whole actions by `action_mask`.

    Args:
        env: a `CleanSwarm` with options as actions, wrapped or not.
        key: key of the observation, as the library wants it: "observation" (PettingZoo, Tianshou), "observations"
            (RLlib).

    """

    def __init__(self, env: ParallelEnv[str, Observations, AgentAction], key: str = "observation") -> None:
        super().__init__(env)
        batch: Batch = self.unwrapped.batch
        counts, mode = batch.choices.counts, batch.action.mode
        if mode == "velocity":
            raise ValueError("MaskedObservations: expected options as actions, got mode 'velocity'")
        self._key, self._told = key, MASK if mode == "option" else OPTION_MASK
        self._mask = MASK if mode == "option" and len(counts) == 1 else OPTION_MASK
        seen = {agent: env.observation_space(agent) for agent in env.possible_agents}
        mask = gymnasium.spaces.Box(0, 1, (sum(counts),), np.int8)
        self._spaces = {agent: gymnasium.spaces.Dict({key: own, self._mask: mask}) for agent, own in seen.items()}

    def observation_space(self, agent: str) -> gymnasium.spaces.Dict:
        """Return the space of an agent's observations: always the same object."""
        return self._spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, dict[str, NDArray[Any]]], AgentInfos]:
        """Begin an episode."""
        observations, infos = self.env.reset(seed=seed, options=options)
        return self._masked(observations, infos), infos

    def step(self, actions: Mapping[str, AgentAction]) -> Any:  # noqa: ANN401  (as AgentsStep, with dictionaries)
        """Run one decision period."""
        observations, *others, infos = self.env.step(actions)
        return (self._masked(observations, infos), *others, infos)

    def _masked(self, observations: dict[str, Observations], infos: AgentInfos) -> dict[str, dict[str, NDArray[Any]]]:
        masks = {agent: np.hstack(infos[agent][self._told]) for agent in observations}
        return {agent: {self._key: seen, self._mask: masks[agent]} for agent, seen in observations.items()}
