"""The cleaning swarm as a PettingZoo environment.

    from clean_swarm_env import clean_swarm_v0

    env = clean_swarm_v0.parallel_env()
    observations, infos = env.reset(seed=1)
    while env.agents:
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)

An action is the option that serves AvoidCollision in that robot for the next decision period; everything else the robot
decides itself. Observations are described in `observation.TERMS`, rewards in `reward.RewardConfig`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils.conversions import parallel_to_aec

from clean_swarm_env.config import MissionConfig, StartConfiguration
from clean_swarm_env.config_files import load_mission
from clean_swarm_env.observation import Observations, Observer
from clean_swarm_env.reward import RewardConfig, rewards
from clean_swarm_env.robot_model import GOAL
from clean_swarm_env.starts import for_start, random_start, run_seed
from clean_swarm_env.worlds import Worlds
from selector.coordinator_model import CoordinatorModel
from selector.knowledge import load_knowledge
from selector.library import Library

Step = tuple[dict[str, Observations], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]


class CleanSwarm(ParallelEnv[str, Observations, int]):
    """One world of cleaning robots; each agent is a robot.

    Args:
        mission: a mission, or the name of one in `configs/missions`.
        reward: weights of the reward's terms.
        render_mode: None or "rgb_array".

    Without `options={"start": StartConfiguration}` each reset draws a new start: episode k after `reset(seed=S)` is
    always the same. An episode terminates when all garbage is dumped and is truncated at the mission's time limit.

    """

    metadata = {"name": "clean_swarm_v0", "render_modes": ["rgb_array"], "is_parallelizable": True}  # noqa: RUF012

    def __init__(
        self,
        mission: MissionConfig | str = "table1",
        reward: RewardConfig | None = None,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: expected None or 'rgb_array', got {render_mode!r}")
        self.mission = load_mission(mission) if isinstance(mission, str) else mission
        self.reward = reward or RewardConfig()
        self.render_mode = render_mode
        self.possible_agents = [f"robot_{row}" for row in range(self.mission.robots.count)]
        self.agents: list[str] = []
        library, knowledge = Library(), load_knowledge(self.mission.knowledge)
        library.check(knowledge)
        self._worlds = Worlds(self.mission, CoordinatorModel(GOAL, knowledge, library))
        self.options = self._worlds.coordinator.model.options
        self._observer = Observer(self._worlds)
        rows = self._worlds.rows
        self._observations: Observations = np.zeros((rows, self._observer.width), dtype=np.float32)
        self._default = np.full(rows, int(np.argmax(knowledge.scores(GOAL))))
        self._ticks_per_step = round(self.mission.decision_period * self.mission.world.control_rate)
        self._tick_limit = max(round(self.mission.time_limit * self.mission.world.control_rate), 1)
        self._seed: int | None = None
        self._episode = 0
        self.observation_spaces = {agent: _box(self._observer.width) for agent in self.possible_agents}
        self.action_spaces = {agent: gymnasium.spaces.Discrete(len(self.options)) for agent in self.possible_agents}
        self.state_space = _box(self._observations.size)

    def observation_space(self, agent: str) -> gymnasium.spaces.Box:
        """Return the space of an agent's observations: always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.spaces.Discrete:
        """Return the space of an agent's actions: always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observations], dict[str, dict[str, Any]]]:
        """Begin an episode; `options["start"]` may give a `StartConfiguration` (other keys are left alone)."""
        if seed is not None or self._seed is None:
            self._seed = int(np.random.SeedSequence(seed).entropy) if seed is None else int(seed)  # type: ignore[arg-type]
            self._episode = 0
        start = (options or {}).get("start")
        if start is None:
            start = random_start(self.mission, self._seed, self._episode)
        elif not isinstance(start, StartConfiguration):
            raise TypeError(f"options['start']: expected a StartConfiguration, got {type(start).__name__}")
        else:
            for_start(self.mission, start)
        self._worlds.reset(0, start, run_seed(self._seed, f"episode {self._episode}"))
        self._worlds.hold(self._default)
        self._episode += 1
        self.agents = list(self.possible_agents)
        return self._observed(), {agent: {} for agent in self.agents}

    def step(self, actions: Mapping[str, int]) -> Step:
        """Let each robot hold its option for one decision period; the period ends early when the mission does."""
        if not self.agents:
            raise RuntimeError("step: the episode is over (or has not begun), call reset first")
        self._worlds.hold(self._checked(actions))
        garbage, counter = self._worlds.garbage, self._worlds.collisions
        before, ticks = int(garbage.done[0]), int(self._worlds.ticks[0])
        entered = np.zeros(self._worlds.rows, dtype=np.int64)
        for _ in range(self._ticks_per_step):
            entered += self._worlds.tick()
            if garbage.done[0] == self.mission.garbage.count or self._worlds.ticks[0] == self._tick_limit:
                break
        seconds = np.array([(int(self._worlds.ticks[0]) - ticks) * self._worlds.period])
        dumped = garbage.done - before
        gained = rewards(self.reward, dumped, seconds, entered, self._worlds.robots)
        terminated = bool(garbage.done[0] == self.mission.garbage.count)
        truncated = not terminated and bool(self._worlds.ticks[0] >= self._tick_limit)
        infos = {
            agent: {
                "time_s": int(self._worlds.ticks[0]) * self._worlds.period,
                "dumped": int(dumped[0]),
                "collision_events": int(entered[row]),
                "collision_samples": int(counter.samples[0, 0]),
            }
            for row, agent in enumerate(self.agents)
        }
        result = (
            self._observed(),
            dict(zip(self.agents, gained.tolist(), strict=True)),
            dict.fromkeys(self.agents, terminated),
            dict.fromkeys(self.agents, truncated),
            infos,
        )
        if terminated or truncated:
            self.agents = []
        return result

    def render(self) -> NDArray[np.uint8] | None:
        """Return the world as a picture (height, width, 3), or None without a render mode."""
        if self.render_mode is None:
            return None
        from clean_swarm_env.portrait import portrait  # drawing is slow to import and seldom wanted

        return portrait(self._worlds, 0)

    def state(self) -> Observations:
        """Return all observations as one array (N * F,)."""
        self._observer.observe(self._observations)
        return self._observations.ravel().copy()

    def _observed(self) -> dict[str, Observations]:
        self._observer.observe(self._observations)
        return dict(zip(self.agents, self._observations.copy(), strict=True))

    def _checked(self, actions: Mapping[str, int]) -> NDArray[np.int64]:
        """Return the options (N,) that `actions` names, or raise ValueError."""
        if actions.keys() != set(self.agents):
            missing, unknown = sorted(set(self.agents) - actions.keys()), sorted(actions.keys() - set(self.agents))
            raise ValueError(f"actions: expected one for each agent, missing {missing}, unknown {unknown}")
        for agent, action in actions.items():
            if not self.action_spaces[agent].contains(action):
                raise ValueError(f"actions[{agent!r}]: expected 0..{len(self.options) - 1}, got {action!r}")
        return np.fromiter((actions[agent] for agent in self.agents), np.int64, len(self.agents))


def _box(width: int) -> gymnasium.spaces.Box:
    return gymnasium.spaces.Box(-1.0, 1.0, (width,), np.float32)


def parallel_env(
    mission: MissionConfig | str = "table1", reward: RewardConfig | None = None, render_mode: str | None = None
) -> CleanSwarm:
    """Return the environment in which all robots act at once; see `CleanSwarm` for the arguments."""
    return CleanSwarm(mission, reward, render_mode)


def env(
    mission: MissionConfig | str = "table1", reward: RewardConfig | None = None, render_mode: str | None = None
) -> AECEnv[str, Observations, int]:
    """Return the environment in which robots act one after the other (by PettingZoo's own conversion)."""
    return parallel_to_aec(CleanSwarm(mission, reward, render_mode))
