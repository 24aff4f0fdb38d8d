"""Many worlds as a vectorised environment of Stable-Baselines3, with one set of parameters for all robots.

    envs = RobotVecEnv(worlds=64)
    PPO("MlpPolicy", envs).learn(100_000)

    mix = RobotVecEnv(batches=[*family_batches("crowded", 8), *family_batches("unseen", 24)])

Every robot of every world is an environment; the rows of several batches come one after the other. A world whose
mission is over starts its next episode in the same step. Infos have in every step what
`clean_swarm_env.borders.infos` names
(`VecMonitor` keeps figures of missions by `info_keywords`), and at the end of a mission:

- `terminal_observation` and `TimeLimit.truncated` (the time was over and garbage was left),
- `episode`: return, length and time, as `VecMonitor` writes them.

Making it sets one torch thread, unless OMP_NUM_THREADS says otherwise: networks of this size take several times the CPU
time with more. `ep_rew_mean` is nan until the first mission ends; `time_limit=300.0` ends those of "table1" after 300
decisions in place of 3,000.

World w of `seed(S)` has the seed S + w. Options of `set_options` may hold a `start`, in the row of the first robot of a
world.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from typing import Any, Unpack

import gymnasium
import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices, VecEnvStepReturn

from clean_swarm_env.borders.infos import Info, robot_infos
from clean_swarm_env.borders.settings import VectorSettings, spelled_out
from clean_swarm_env.borders.spaces import Member, flat_space, observation_space, preferred, start_of
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.given import seeds_from
from clean_swarm_env.learning.interface import BatchStep, Finished
from clean_swarm_env.learning.joined import Joined, blocks
from clean_swarm_env.learning.observation.observer import Observations
from selforg.arrays import Flags, Ints
from selforg.sealing import check_alike, sealed, unsealed


class RobotVecEnv(VecEnv):
    """The robots of many worlds.

    Args:
        worlds: W, for worlds of one mission or family.
        batches: batches that are used in place of `worlds` and `settings`; see `clean_swarm_env.learning.joined`.
            Their goals and options may differ: `action_masks` says which a robot has.
        threads: number of threads that step the worlds, with the same results for any number.
        settings: see `VectorSettings`.

    Attributes:
        batches: the batches, as many as `threads` unless others are given.
        options: goal -> names of the options of all batches, which the numbers of actions mean.
        finished: the missions that ended in the last period.

    """

    @spelled_out
    def __init__(
        self,
        worlds: int = 1,
        *,
        batches: Sequence[Batch] = (),
        threads: int = 1,
        **settings: Unpack[VectorSettings],
    ) -> None:
        if "OMP_NUM_THREADS" not in os.environ:
            torch.set_num_threads(1)
        if batches and (settings or worlds != 1):
            raise ValueError(
                f"RobotVecEnv: expected batches or settings of one, got both, {sorted(settings) or worlds}"
            )
        self._joined = Joined(batches or blocks(worlds=worlds, threads=threads, **settings), threads)
        self.batches = self._joined.batches
        self.finished: tuple[Finished, ...] = ()
        own = [(batch, row) for batch in self.batches for row in range(batch.rows)]
        worlds_of = self._joined.world_of.tolist()
        self._robots = [
            Member(batch, world, slice(row, row + 1)) for (batch, row), world in zip(own, worlds_of, strict=True)
        ]
        self._actions: NDArray[Any] = np.zeros(0)
        self._returns = np.zeros(self._joined.rows)
        self._lengths = np.zeros(self._joined.worlds, dtype=np.int64)
        self._began = time.monotonic()
        first, self.options = self.batches[0], self._joined.options
        self._choices = self._joined.counts if first.action.mode == "both" else ()
        space = flat_space(self.options, first.action.mode)
        super().__init__(self._joined.rows, observation_space(first), space)

    def reset(self) -> Observations:
        """Begin an episode in every world; seeds and options given before are used once."""
        firsts = self._joined.first_rows.tolist()
        starts = [start_of(self._options[row]) for row in firsts]
        observations = self._joined.reset([self._seeds[row] for row in firsts], starts)
        self._reset_seeds()
        self._reset_options()
        self.finished = ()
        self._returns[:], self._lengths[:] = 0.0, 0
        return observations

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Give world w the seed `seed` + w from the next reset on; without one, seeds drawn from the system."""
        (given,) = seeds_from([seed], 1)
        first = int(np.random.default_rng().integers(2**32)) if given is None else given
        self._seeds = [first + world for world in self._joined.world_of.tolist()]
        return self._seeds

    def step_async(self, actions: NDArray[Any]) -> None:
        """Note the actions of the coming step."""
        self._actions = np.asarray(actions)
        if self._actions.shape[1:] == self.action_space.shape and self._choices:
            self._actions = preferred(self._actions, self._choices)

    def step_wait(self) -> VecEnvStepReturn:
        """Run one decision period."""
        step = self._joined.step(self._actions)
        self.finished = self._joined.finished
        self._returns += step.rewards
        self._lengths += 1
        infos = [info for batch in self.batches for info in robot_infos(batch)]
        for end in self.finished:
            self._add_end(infos, end, step)
        over = (step.terminated | step.truncated)[self._joined.world_of]
        return step.observations, step.rewards.astype(np.float32), over, infos

    def _add_end(self, infos: list[Info], end: Finished, step: BatchStep) -> None:
        """Add the figures of a mission to the infos, and set the sums of its world to 0."""
        elapsed, length = round(time.monotonic() - self._began, 6), int(self._lengths[end.world])
        for row in np.flatnonzero(self._joined.world_of == end.world).tolist():
            infos[row]["terminal_observation"] = step.final_observations[row].copy()
            infos[row]["TimeLimit.truncated"] = bool(step.truncated[end.world])
            infos[row]["episode"] = {"r": float(self._returns[row]), "l": length, "t": elapsed}
            self._returns[row] = 0.0
        self._lengths[end.world] = 0

    def get_state(self) -> bytes:
        """Return the states of all worlds, with what episodes have brought so far; see `Batch.get_state`."""
        return sealed("robots", (self._sizes(), self._joined.get_state(), self._returns, self._lengths))

    def set_state(self, state: bytes) -> Observations:
        """Go on from a state of as many worlds, in any number of threads; return the observations.

        ValueError says what is damaged or does not fit, and then nothing has changed.
        """
        sizes, states, returns, lengths = unsealed("robots", state)
        check_alike(self._sizes(), sizes)
        seen = self._joined.set_state(states)
        self._returns[:], self._lengths[:], self.finished = returns, lengths, ()
        return seen

    def _sizes(self) -> dict[str, Any]:
        return {"worlds": self._joined.worlds, "robots": self._joined.rows}

    def action_masks(self) -> Flags:
        """Return which options (R, O) of all goals, one goal after the other, can serve next."""
        return self._joined.masks()

    def default_options(self) -> Ints:
        """Return the option (R, C) of the highest expert score of each goal."""
        return self._joined.defaults()

    def close(self) -> None:
        """End the recordings of missions that are still going on."""
        self._joined.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return an attribute of the rows; AttributeError if the rows do not have it."""
        return [getattr(robot, attr_name) for robot in self._chosen(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:  # noqa: ANN401
        """Set an attribute of the rows; attributes that follow from the batch cannot be set."""
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
        """Return False for each row: rows are not wrapped one by one."""
        return [False for _ in self._chosen(indices)]

    def _chosen(self, indices: VecEnvIndices) -> list[Member]:
        return [self._robots[index] for index in self._get_indices(indices)]
