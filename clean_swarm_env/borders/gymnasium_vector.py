"""Many worlds as a Gymnasium vector environment: each robot is an environment of its own, or each team is one.

    envs = RobotVectorEnv(worlds=64)
    observations, infos = envs.reset(seed=1)
    observations, rewards, terminations, truncations, infos = envs.step(envs.action_space.sample())

A world whose mission is over begins anew in the same step (`AutoresetMode.SAME_STEP`). The observation returned is the
first of the new episode. `infos["final_obs"]` holds the last one of the old episode, `infos["final_info"]` the figures
of the mission. World w of `reset(seed=S)` has the seed S + w.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from clean_swarm_env.borders.spaces import action_space, observation_space, start_of
from clean_swarm_env.learning.batch import Batch, Finished
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.learning.progress import EVENTS
from selforg.arrays import Flags, Floats

Infos = dict[str, Any]


class BatchVectorEnv(VectorEnv[Observations, NDArray[Any], NDArray[Any]]):
    """The base class of both kinds: E environments of `together` rows each, E * together = R.

    Args:
        batch: the worlds.
        together: rows of one environment: 1, or the number of robots of a world.

    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": []}  # noqa: RUF012

    def __init__(self, batch: Batch, together: int) -> None:
        self.batch, self._together = batch, together
        self.num_envs = batch.rows // together
        self._per_world = batch.robots // together
        self.single_observation_space = observation_space(batch, together)
        self.single_action_space = action_space(batch, together)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, Infos]:
        """Begin an episode in every world; `seed` may be one for each world, `options["start"]` a start for all."""
        super().reset(seed=seed if isinstance(seed, int) else None)
        worlds = self.batch.worlds.worlds
        seeds = [seed + world for world in range(worlds)] if isinstance(seed, int) else seed
        observations = self.batch.reset(seeds, [start_of(options)] * worlds)
        return self._joined(observations), self._infos()

    def step(self, actions: NDArray[Any]) -> tuple[Observations, Floats, Flags, Flags, Infos]:
        """Run one decision period."""
        step = self.batch.step(self._rows_of(np.asarray(actions)))
        infos = self._infos()
        if self.batch.finished:
            self._add_final(infos, self.batch.finished, step.final_observations)
        return (
            self._joined(step.observations),
            step.rewards.reshape(self.num_envs, -1).mean(axis=1),
            np.repeat(step.terminated, self._per_world),
            np.repeat(step.truncated, self._per_world),
            infos,
        )

    def close_extras(self, **_: object) -> None:
        """End the recordings of missions that are still going on."""
        self.batch.close()

    def _rows_of(self, actions: NDArray[Any]) -> NDArray[Any]:
        """Return the actions (R, ...) of rows."""
        if actions.shape != self.action_space.shape:
            raise ValueError(f"actions: expected shape {self.action_space.shape}, got {actions.shape}")
        return actions.reshape(self.batch.rows, -1)

    def _joined(self, observations: Observations) -> Observations:
        return observations.reshape(self.num_envs, -1).copy()

    def _infos(self) -> Infos:
        """Return what happened in the period (E,), or (E, N) of each robot, and which options can serve next."""
        batch, progress = self.batch, self.batch.progress
        infos: Infos = {
            "time_s": np.repeat(progress.elapsed * batch.worlds.period, self._per_world),
            "dumped": np.repeat(progress.dumped, self._per_world),
            "action_mask": batch.masks().astype(np.int8).reshape(self.num_envs, -1),
        }
        for name, counts in zip(EVENTS, progress.events, strict=True):
            own = counts if self._together == 1 else counts.reshape(self.num_envs, -1)
            infos[f"own_{name}"] = own.copy()
        infos.update({f"_{name}": np.ones(self.num_envs, dtype=np.bool_) for name in tuple(infos)})
        return infos

    def _add_final(self, infos: Infos, finished: Sequence[Finished], final: Observations) -> None:
        """Add the last observations of the missions that ended, and their figures."""
        ended = np.zeros(self.num_envs, dtype=np.bool_)
        last = np.full(self.num_envs, None, dtype=object)
        happened = {name: values for name, values in infos.items() if not name.startswith("_")}
        for end in finished:
            own = slice(end.world * self._per_world, (end.world + 1) * self._per_world)
            ended[own] = True
            for name, value in end.statistics.items():
                happened.setdefault(name, np.zeros(self.num_envs, dtype=type(value)))[own] = value
        for env, seen in zip(np.flatnonzero(ended), self._joined(final)[ended], strict=True):
            last[env] = seen
        infos["final_info"] = happened | {f"_{name}": ended.copy() for name in happened}
        infos |= {"final_obs": last, "_final_obs": ended, "_final_info": ended.copy()}


class RobotVectorEnv(BatchVectorEnv):
    """Every robot of every world is an environment; learners share parameters among them (rows = worlds * robots).

    Args:
        worlds: W; or give `num_envs`, a multiple of the robots of a mission.
        num_envs: W * N, as `gymnasium.make_vec` has it.
        settings: further arguments of `Batch`.

    """

    def __init__(self, worlds: int | None = None, *, num_envs: int | None = None, **settings: Any) -> None:  # noqa: ANN401
        if (worlds is None) == (num_envs is None):
            raise ValueError("RobotVectorEnv: expected either worlds or num_envs")
        if num_envs is not None:
            robots = Batch(**settings).robots
            if num_envs < 1 or num_envs % robots:
                raise ValueError(f"num_envs: expected a multiple of the {robots} robots of a world, got {num_envs}")
            worlds = num_envs // robots
        super().__init__(Batch(worlds=worlds or 1, **settings), 1)


class TeamVectorEnv(BatchVectorEnv):
    """Every world is an environment in which one selector decides for the whole team, as in `CleanSwarmTeam`.

    Args:
        num_envs: W.
        one_for_all: whether one option serves all robots of a team.
        settings: further arguments of `Batch`.

    """

    def __init__(self, num_envs: int = 1, *, one_for_all: bool = False, **settings: Any) -> None:  # noqa: ANN401
        batch = Batch(worlds=num_envs, **settings)
        super().__init__(batch, batch.robots)
        self._one_for_all = one_for_all
        if one_for_all:
            self.single_action_space = action_space(batch)
            self.action_space = batch_space(self.single_action_space, self.num_envs)

    def _rows_of(self, actions: NDArray[Any]) -> NDArray[Any]:
        if not self._one_for_all:
            return super()._rows_of(actions)
        if actions.shape != self.action_space.shape:
            raise ValueError(f"actions: expected shape {self.action_space.shape}, got {actions.shape}")
        return np.repeat(actions.reshape(self.num_envs, -1), self.batch.robots, axis=0)
