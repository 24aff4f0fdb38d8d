"""Many worlds as a vectorised environment of Stable-Baselines3, with one set of parameters for all robots.

    envs = RobotVecEnv(worlds=64)
    PPO("MlpPolicy", envs).learn(100_000)

Every robot of every world is an environment (rows = worlds * robots). A world whose mission is over begins anew in the
same step. Infos are empty but for rows where something happened:

- in the period: `own_picked`, `own_recycled`, `own_dumped`, `own_collision`, where they are not 0;
- at the end of a mission: `terminal_observation`, `TimeLimit.truncated` (the time was over, garbage left), `episode`
  (return, length and time, as `VecMonitor` writes them), and what the mission came to: `duration_s`, `garbage_done`,
  `mission_collision_events`, `completed`, which `VecMonitor` keeps by `info_keywords`.

World w of `seed(S)` has the seed S + w. Options of `set_options` may give a `start`; a world's first robot counts.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices, VecEnvStepReturn

from clean_swarm_env.batch import Batch, Finished
from clean_swarm_env.observation import Observations
from clean_swarm_env.progress import COLLISION, EVENTS
from clean_swarm_env.spaces import action_space, observation_space, start_of

Info = dict[str, Any]


class Robot:
    """A row as others see it: what `get_attr`, `set_attr` and `env_method` of the environment reach.

    Attributes:
        row: its number among all rows.
        world: its world.
        robot: its number within the world.

    """

    spec = None
    render_mode = None

    def __init__(self, batch: Batch, row: int) -> None:
        self.row = row
        self.world, self.robot = divmod(row, batch.robots)
        self._batch = batch

    @property
    def batch(self) -> Batch:
        """All worlds."""
        return self._batch

    @property
    def options(self) -> dict[str, tuple[str, ...]]:
        """Coordinated goal -> names of its options."""
        return dict(self._batch.options)

    @property
    def observation_space(self) -> gymnasium.spaces.Box:
        """Space of the observations."""
        return observation_space(self._batch)

    @property
    def action_space(self) -> gymnasium.Space[Any]:
        """Space of the actions."""
        return action_space(self._batch)

    def action_masks(self) -> NDArray[np.bool_]:
        """Return which options (O,) can serve next, those of all goals one after the other, as sb3-contrib asks."""
        masks: NDArray[np.bool_] = self._batch.masks()[self.row]
        return masks


class RobotVecEnv(VecEnv):
    """W worlds of one mission; `settings` are further arguments of `Batch`."""

    def __init__(self, worlds: int = 1, **settings: Any) -> None:  # noqa: ANN401
        self.batch = Batch(worlds=worlds, **settings)
        self._robots = [Robot(self.batch, row) for row in range(self.batch.rows)]
        self._actions: NDArray[Any] = np.zeros(0)
        self._returns = np.zeros(self.batch.rows)
        self._lengths = np.zeros(worlds, dtype=np.int64)
        self._began = time.time()
        super().__init__(self.batch.rows, observation_space(self.batch), action_space(self.batch))

    def reset(self) -> Observations:
        """Begin an episode in every world; seeds and options given before count this once."""
        robots = self.batch.robots
        starts = [start_of(options) for options in self._options[::robots]]
        observations = self.batch.reset(self._seeds[::robots], starts)
        self._reset_seeds()
        self._reset_options()
        self._returns[:], self._lengths[:] = 0.0, 0
        return observations.copy()

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Give world w the seed `seed` + w from the next reset on; without one, seeds that nobody knows."""
        first = int(np.random.default_rng().integers(2**32)) if seed is None else seed
        self._seeds = [first + row // self.batch.robots for row in range(self.num_envs)]
        return self._seeds

    def step_async(self, actions: NDArray[Any]) -> None:
        """Note the actions of the coming step."""
        self._actions = np.asarray(actions)

    def step_wait(self) -> VecEnvStepReturn:
        """Let all robots act for one decision period."""
        step = self.batch.step(self._actions)
        self._returns += step.rewards
        self._lengths += 1
        infos = self._infos()
        for end in self.batch.finished:
            self._add_end(infos, end, step.final_observations, truncated=bool(step.truncated[end.world]))
        over = np.repeat(step.terminated | step.truncated, self.batch.robots)
        return step.observations.copy(), step.rewards.astype(np.float32), over, infos

    def _infos(self) -> list[Info]:
        """Return what happened in the period, for each row."""
        infos: list[Info] = [{} for _ in range(self.num_envs)]
        events = self.batch.progress.events[: COLLISION + 1]
        for kind, row in np.argwhere(events).tolist():
            infos[row][f"own_{EVENTS[kind]}"] = int(events[kind, row])
        return infos

    def _add_end(self, infos: list[Info], end: Finished, final: Observations, *, truncated: bool) -> None:
        """Add what a mission came to and begin the sums of the next one."""
        elapsed = round(time.time() - self._began, 6)
        for row in self.batch.worlds.rows_of(end.world).tolist():
            infos[row] |= end.statistics
            infos[row]["terminal_observation"] = final[row].copy()
            infos[row]["TimeLimit.truncated"] = truncated
            total, length = float(self._returns[row]), int(self._lengths[end.world])
            infos[row]["episode"] = {"r": total, "l": length, "t": elapsed}
            self._returns[row] = 0.0
        self._lengths[end.world] = 0

    def close(self) -> None:
        """Nothing has to be closed."""

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of the rows; one that a row does not have raises AttributeError."""
        return [getattr(robot, attr_name) for robot in self._chosen(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:  # noqa: ANN401
        """Set an attribute of the rows; those that follow from the batch cannot be set."""
        for robot in self._chosen(indices):
            setattr(robot, attr_name, value)

    def env_method(
        self,
        method_name: str,
        *method_args: Any,  # noqa: ANN401
        indices: VecEnvIndices = None,
        **method_kwargs: Any,  # noqa: ANN401
    ) -> list[Any]:
        """Call a method of the rows, such as `action_masks`."""
        return [getattr(robot, method_name)(*method_args, **method_kwargs) for robot in self._chosen(indices)]

    def env_is_wrapped(
        self, wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]], indices: VecEnvIndices = None
    ) -> list[bool]:
        """Return that no row is wrapped by itself."""
        return [False for _ in self._chosen(indices)]

    def _chosen(self, indices: VecEnvIndices) -> list[Robot]:
        return [self._robots[index] for index in self._get_indices(indices)]
