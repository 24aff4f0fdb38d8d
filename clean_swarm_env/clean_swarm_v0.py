"""The cleaning swarm as a PettingZoo environment.

    from clean_swarm_env import clean_swarm_v0

    env = clean_swarm_v0.parallel_env()
    observations, infos = env.reset(seed=1)
    while env.agents:
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)

An action is the option that serves AvoidCollision in that robot for the next decision period; with several coordinated
goals it is one option for each. The robot's network decides the rest. With `ActionConfig(mode="velocity")` an action is
a movement vector. `learning.observation` describes the observations, `learning.reward` the rewards.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils.conversions import parallel_to_aec

from clean_swarm_env.borders.spaces import action_space, masks_of, observation_space, start_of
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.learning.reward import RewardConfig

AgentAction = int | NDArray[np.int64] | NDArray[np.float32]
AgentInfos = dict[str, dict[str, Any]]
AgentsStep = tuple[dict[str, Observations], dict[str, float], dict[str, bool], dict[str, bool], AgentInfos]


class CleanSwarm(ParallelEnv[str, Observations, AgentAction]):
    """One world of cleaning robots; each agent is a robot.

    Args:
        mission: a mission, or the name of one in `configs/missions`.
        observation: terms of the observation.
        reward: weights of the reward's terms.
        action: what an action is.
        render_mode: None or "rgb_array".
        settings: further arguments of `Batch`, such as `family` and `knowledge`.

    Without `options={"start": StartConfiguration}` each reset draws a new start; episode k after `reset(seed=S)` is
    always the same. An episode terminates when all garbage is dumped and is truncated at the mission's time limit. The
    agents are the robots at work. A robot that fails or is taken away terminates and does not come back. A robot that
    joins during the mission is a possible agent from the beginning, and an agent from the end of the step in which it
    joins. Infos hold the time, the counts of the period, and the `action_mask` of options that can serve next.

    Attributes:
        options: coordinated goal -> names of its options.

    """

    metadata = {"name": "clean_swarm_v0", "render_modes": ["rgb_array"], "is_parallelizable": True}  # noqa: RUF012

    def __init__(
        self,
        mission: MissionConfig | str = "table1",
        reward: RewardConfig | None = None,
        render_mode: str | None = None,
        *,
        observation: ObservationConfig | None = None,
        action: ActionConfig | None = None,
        **settings: Any,  # noqa: ANN401  (those of Batch)
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: expected None or 'rgb_array', got {render_mode!r}")
        self._batch = Batch(
            mission, observation=observation, reward=reward, action=action, begin_anew=False, **settings
        )
        self.mission, self.options = self._batch.mission, self._batch.options
        self.render_mode = render_mode
        self.possible_agents = [f"robot_{row}" for row in range(self._batch.robots)]
        self.agents: list[str] = []
        self.observation_spaces = {agent: observation_space(self._batch) for agent in self.possible_agents}
        self.action_spaces = {agent: action_space(self._batch) for agent in self.possible_agents}
        self.state_space = observation_space(self._batch, self._batch.robots)
        space = action_space(self._batch)
        self._choices = int(space.n) if isinstance(space, gymnasium.spaces.Discrete) else 0

    def observation_space(self, agent: str) -> gymnasium.spaces.Box:
        """Return the space of an agent's observations: always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the space of an agent's actions: always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observations], AgentInfos]:
        """Begin an episode; `options["start"]` may give a `StartConfiguration` (other keys are ignored)."""
        seen = self._batch.reset([seed], [start_of(options)])
        self.agents = self._at_work()
        return self._of(self.agents, seen.copy()), self._infos(self.agents)

    def step(self, actions: Mapping[str, AgentAction]) -> AgentsStep:
        """Run one decision period; the period ends early when the mission does."""
        if not self.agents:
            raise RuntimeError("step: the episode is over (or has not begun), call reset first")
        step = self._batch.step(self._checked(actions))
        terminated, truncated = bool(step.terminated[0]), bool(step.truncated[0])
        before, after = self.agents, self._at_work()
        gone, joined = set(before).difference(after), set(after).difference(before)
        there = [agent for agent in self.possible_agents if agent in before or agent in joined] if joined else before
        gained = self._of(there, step.rewards.tolist()) | dict.fromkeys(joined, 0.0)
        result = (
            self._of(there, step.observations.copy()),
            gained,
            {agent: terminated or agent in gone for agent in there},
            {agent: truncated and agent not in gone for agent in there},
            self._infos(there),
        )
        self.agents = [] if terminated or truncated else after
        return result

    def _at_work(self) -> list[str]:
        working = self._batch.worlds.team.working.tolist()
        return [agent for agent, works in zip(self.possible_agents, working, strict=True) if works]

    def _infos(self, agents: list[str]) -> AgentInfos:
        """Return the counts of the period, of the team and of each agent, and the options that can serve next."""
        progress, worlds = self._batch.progress, self._batch.worlds
        team = {
            "time_s": int(progress.elapsed[0]) * worlds.period,
            "dumped": int(progress.dumped[0]),
            "collision_samples": int(worlds.collisions.samples[0, 0]),
        }
        infos = {}
        for agent, (picked, recycled, dumped, collisions, contact, avoiding), able in zip(
            self.possible_agents, progress.events.T.tolist(), masks_of(self._batch), strict=True
        ):
            infos[agent] = {
                **team,
                "own_picked": picked,
                "own_recycled": recycled,
                "own_dumped": dumped,
                "collision_events": collisions,
                "contact_s": contact * worlds.period,
                "avoiding_s": avoiding * worlds.period,
                "action_mask": able,
            }
        return infos if len(agents) == len(infos) else {agent: infos[agent] for agent in agents}

    def close(self) -> None:
        """End the recording of a mission that is still going on."""
        self._batch.close()

    def render(self) -> NDArray[np.uint8] | None:
        """Return the world as a picture (height, width, 3), or None without a render mode."""
        if self.render_mode is None:
            return None
        from clean_swarm_env.drawing.world_picture import portrait  # drawing is slow to import and seldom wanted

        return portrait(self._batch.worlds, 0)

    def state(self) -> Observations:
        """Return all observations as one array (N * F,)."""
        return self._batch.observations.ravel().copy()

    def _of(self, agents: list[str], rows: Iterable[Any]) -> dict[str, Any]:
        """Return the values of `agents` among `rows` (N,)."""
        every = dict(zip(self.possible_agents, rows, strict=True))
        return every if len(agents) == len(every) else {agent: every[agent] for agent in agents}

    def _checked(self, actions: Mapping[str, AgentAction]) -> NDArray[Any]:
        """Return `actions` as rows, or raise ValueError."""
        if actions.keys() != set(self.agents):
            missing, unknown = sorted(set(self.agents) - actions.keys()), sorted(actions.keys() - set(self.agents))
            raise ValueError(f"actions: expected one for each agent, missing {missing}, unknown {unknown}")
        choices = self._choices
        for agent, action in actions.items():
            if choices and isinstance(action, int | np.integer) and 0 <= action < choices:
                continue  # the answer of `contains`, in a tenth of its time
            space = self.action_spaces[agent]
            if not space.contains(action):
                expected = f"0..{space.n - 1}" if isinstance(space, gymnasium.spaces.Discrete) else repr(space)
                raise ValueError(f"actions[{agent!r}]: expected {expected}, got {action!r}")
        default: NDArray[Any] = self._batch.choices.default if self._batch.action.mode == "option" else np.zeros(2)
        first = default.reshape(np.shape(actions[self.agents[0]]))  # the action of robots that join during the period
        return np.array([actions.get(agent, first) for agent in self.possible_agents])


def parallel_env(
    mission: MissionConfig | str = "table1",
    reward: RewardConfig | None = None,
    render_mode: str | None = None,
    **settings: Any,  # noqa: ANN401  (the rest of the arguments of CleanSwarm)
) -> CleanSwarm:
    """Return the environment in which all robots act at once; see `CleanSwarm` for the arguments."""
    return CleanSwarm(mission, reward, render_mode, **settings)


def env(
    mission: MissionConfig | str = "table1",
    reward: RewardConfig | None = None,
    render_mode: str | None = None,
    **settings: Any,  # noqa: ANN401  (the rest of the arguments of CleanSwarm)
) -> AECEnv[str, Observations, AgentAction]:
    """Return the environment in which robots act one after the other (by PettingZoo's own conversion)."""
    return parallel_to_aec(CleanSwarm(mission, reward, render_mode, **settings))
