"""Many worlds as a vectorised environment of Stable-Baselines3, with one set of parameters for all robots.

    envs = RobotVecEnv(worlds=64)
    PPO("MlpPolicy", envs).learn(100_000)

    mix = RobotVecEnv(batches=[*batches_of("crowded", 8), *batches_of("unseen", 24)])

Every robot of every world is an environment; the rows of several batches come one after the other. A world whose
mission is over starts its next episode in the same step. Infos have in every step what
`clean_swarm_env.borders.infos` names
(`VecMonitor` keeps figures of missions by `info_keywords`), and at the end of a mission:

- `terminal_observation` and `TimeLimit.truncated` (the time was over and garbage was left),
- `episode`: return, length and time, as `VecMonitor` writes them, for robots that took part. So `ep_rew_mean` is that
  of real robots; `VecMonitor` has a return of 0 for each row without a robot.

`evaluate_missions` and `MissionCallback` evaluate by missions. `evaluate_policy` and `EvalCallback` of
Stable-Baselines3 evaluate by rows: fifty episodes of five robots are ten missions, and rows without a robot count.

Making it sets one torch thread, unless OMP_NUM_THREADS says otherwise: networks of this size take several times the CPU
time with more. `ep_rew_mean` is nan until the first mission ends; `time_limit=300.0` ends those of "table1" after 300
decisions in place of 3,000.

`seed(S)` gives each world a seed of its own that follows from S, and returns them (docs/environment.md#seeds). Options
of `set_options` may hold a `start`, in the row of the first robot of a world.
"""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Sequence
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any, Unpack

import gymnasium
import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.type_aliases import PolicyPredictor
from stable_baselines3.common.vec_env import sync_envs_normalization
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices, VecEnvStepReturn

from clean_swarm_env.borders.infos import Info, robot_infos
from clean_swarm_env.borders.settings import spelled_out
from clean_swarm_env.borders.spaces import Member, flat_space, members, observation_space, preferred, start_of
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.episodes import EnvSettings
from clean_swarm_env.learning.given import GivenMission, seeds_from, whole_number
from clean_swarm_env.learning.interface import BatchStep, Finished
from clean_swarm_env.learning.joined import Joined, batches_of
from clean_swarm_env.learning.observation.observer import Observations
from selforg.arrays import Flags

OPEN_TEAM = (
    "robots join during these missions: VecMonitor, evaluate_policy and EvalCallback count rows that no robot has as "
    "episodes of return 0; use clean_swarm_env.sb3.evaluate_missions and MissionCallback"
)
"""Warning for what counts rows and not robots."""
Mission = dict[str, Any]
"""Figures of a mission: `return`, the mean over the robots that took part, `robots`, their number, `cost_s`, and what
infos say at its end."""


class RobotVecEnv(VecEnv):
    """The robots of many worlds.

    Args:
        worlds: W, for worlds of one mission or family.
        mission: its name in `configs/missions` ("table1" unless given), its path, its keys, or the model.
        batches: batches that are used in place of `worlds` and `settings`; see `clean_swarm_env.learning.joined`.
            Their goals and options may differ: `action_masks` says which a robot has.
        threads: number of threads that step the worlds, with the same results for any number.
        settings: see `EnvSettings`.

    Attributes:
        joined: the worlds.
        batches: the batches, as many as `threads` unless others are given.
        options: goal -> names of the options of all batches, which the numbers of actions mean.
        worlds: W, of all batches.

    """

    @spelled_out
    def __init__(
        self,
        worlds: int = 1,
        mission: GivenMission | None = None,
        *,
        batches: Sequence[Batch] = (),
        threads: int = 1,
        **settings: Unpack[EnvSettings],
    ) -> None:
        if "OMP_NUM_THREADS" not in os.environ:
            torch.set_num_threads(1)
        given = sorted(settings) or mission or worlds
        if batches and given != 1:
            raise ValueError(f"RobotVecEnv: expected batches or settings of one, got both, {given}")
        self.joined = Joined(batches or batches_of(mission, worlds, threads, **settings), threads)
        self.batches, self.worlds, self.options = self.joined.batches, self.joined.count, self.joined.options
        self._robots = members(self.joined)
        self._actions: NDArray[Any] = np.zeros(0)
        self._began = time.monotonic()
        both = self.batches[0].action.mode == "both"
        self._choices = [len(names) for names in self.options.values()] if both else []
        super().__init__(self.joined.rows, observation_space(self.joined), flat_space(self.joined))

    def reset(self) -> Observations:
        """Begin an episode in every world; seeds and options given before are used once."""
        starts = [start_of(self._options[row]) for row in self.joined.first_rows.tolist()]
        observations = self.joined.reset(self._seeds, starts)
        self._reset_seeds()
        self._reset_options()
        return observations

    def seed(self, seed: int | Sequence[int | None] | None = None) -> Sequence[int | None]:
        """Give the worlds seeds from the next reset on; return those of the rows' worlds.

        Seeds are the children of one number, drawn from the system without one, or those of a list, of worlds or of
        rows. `parallel_env` repeats a world by its seed.
        """
        given = int(np.random.default_rng().integers(2**32)) if seed is None else seed
        seeds = seeds_from(given, self.joined.first_rows.tolist(), self.joined.rows)
        self._seeds = [seeds[world] for world in self.joined.world_of.tolist()]
        return self._seeds

    def step_async(self, actions: NDArray[Any]) -> None:
        """Note the actions of the coming step."""
        self._actions = np.asarray(actions)
        if self._actions.shape[1:] == self.action_space.shape and self._choices:
            self._actions = preferred(self._actions, self._choices)

    def step_wait(self) -> VecEnvStepReturn:
        """Run one decision period."""
        step = self.joined.step(self._actions)
        infos = [info for batch in self.batches for info in robot_infos(batch)]
        for end in self.joined.finished:
            self._add_end(infos, end, step)
        over = (step.terminated | step.truncated)[self.joined.world_of]
        return step.observations, step.rewards.astype(np.float32), over, infos

    def _add_end(self, infos: list[Info], end: Finished, step: BatchStep) -> None:
        """Add the figures of a mission to the infos of its rows."""
        first, elapsed = int(self.joined.first_rows[end.world]), round(time.monotonic() - self._began, 6)
        for row in np.flatnonzero(self.joined.world_of == end.world).tolist():
            infos[row]["terminal_observation"] = step.final_observations[row].copy()
            infos[row]["TimeLimit.truncated"] = bool(step.truncated[end.world])
        for info, gained in zip(infos[first:], end.returns, strict=False):
            info["episode"] = {"r": gained, "l": end.steps, "t": elapsed}

    def get_state(self, worlds: Sequence[int] | None = None) -> bytes:
        """Return the states of `worlds`, or of all; see `Batch.get_state`."""
        return self.joined.get_state(worlds)

    def set_state(self, state: bytes, worlds: Sequence[int] | None = None) -> Observations:
        """Make `worlds`, or all, go on from a state, see `Batch.set_state`; return all observations."""
        return self.joined.set_state(state, worlds)

    @property
    def finished(self) -> tuple[Finished, ...]:
        """The missions that ended in the last period, with the return of each robot."""
        return self.joined.finished

    def action_masks(self) -> Flags:
        """Return which options (R, O) of all goals, one goal after the other, can serve next."""
        return self.joined.masks()

    def close(self) -> None:
        """End the recordings of missions that are still going on."""
        self.joined.close()

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
        """Return False for each row: rows are not wrapped one by one.

        `VecMonitor` and `evaluate_policy` ask for `Monitor`, and are warned of teams with rows that no robot may have.
        """
        if wrapper_class is Monitor and any(batch.open_team for batch in self.batches):
            warnings.warn(OPEN_TEAM, stacklevel=3)
        return [False for _ in self._chosen(indices)]

    def _chosen(self, indices: VecEnvIndices) -> list[Member]:
        return [self._robots[index] for index in self._get_indices(indices)]


def evaluate_missions(
    model: PolicyPredictor, envs: VecEnv, missions: int = 24, *, seed: int = 0, deterministic: bool = True
) -> list[Mission]:
    """Return the figures of missions in which a model decides; robots that do not exist are not counted.

    Each world does the first of its missions of `seed`, as many as the others or one more: those that end soon are not
    preferred.

    Args:
        model: predicts actions; `action_masks` are given to models that take them.
        envs: a `RobotVecEnv`, wrapped or not, in which the model does not learn: its missions are begun anew. Of a
            `VecNormalize`, `training` should be False.
        missions: number of missions.
        seed: that of the worlds, as in `RobotVecEnv.seed`.
        deterministic: whether actions are the likeliest ones.

    """
    robots, predict = _robots_of(envs), partial(model.predict, deterministic=deterministic)
    asked, masked = whole_number(missions, "missions", 1), "action_masks" in signature(model.predict).parameters
    left = [len(range(world, asked, robots.worlds)) for world in range(robots.worlds)]
    told: list[Mission] = []
    state, begins = None, np.ones(envs.num_envs, dtype=np.bool_)
    envs.seed(seed)
    seen = envs.reset()
    while any(left):
        masks = {"action_masks": robots.action_masks()} if masked else {}
        actions, state = predict(seen, state=state, episode_start=begins, **masks)
        seen, _, begins, _ = envs.step(actions)
        for end in robots.finished:
            if left[end.world]:
                left[end.world] -= 1
                gained = float(np.mean(end.returns))
                figures = {"return": gained, "robots": end.result.robots, "cost_s": end.result.cost_s}
                told.append({"scenario": end.scenario.id, **figures, **end.statistics})
    return told


class MissionCallback(BaseCallback):
    """Evaluate by missions while a model learns, and keep the model of the highest mean return.

    Args:
        envs: see `evaluate_missions`; not the worlds in which the model learns.
        missions: number of missions of each evaluation, always the same ones.
        every: decisions of robots between evaluations.
        path: where the best model is saved; nowhere unless given.

    Attributes:
        told: number of decisions -> figures of the missions.
        best: highest mean return.

    """

    def __init__(self, envs: VecEnv, missions: int = 24, *, every: int = 100_000, path: str | Path = "") -> None:
        super().__init__()
        self.envs, self.missions, self.every, self.path = envs, missions, every, path
        self.told: dict[int, list[Mission]] = {}
        self.best = -np.inf

    def _on_step(self) -> bool:
        """Evaluate if it is time; PPO calls this after each step and continues if it is True."""
        if self.num_timesteps < max(self.told, default=0) + self.every:
            return True
        if _robots_of(self.training_env) is _robots_of(self.envs):
            raise ValueError("envs: expected other worlds than those in which the model learns, got the same")
        if self.model.get_vec_normalize_env() is not None:
            sync_envs_normalization(self.training_env, self.envs)
        told = self.told[self.num_timesteps] = evaluate_missions(self.model, self.envs, self.missions)
        for name in ("return", "cost_s", "completed"):
            self.logger.record(f"eval/mean_{name}", float(np.mean([mission[name] for mission in told])))
        mean = float(np.mean([mission["return"] for mission in told]))
        if mean > self.best:
            self.best = mean
            if self.path:
                self.model.save(self.path)
        return True


def _robots_of(envs: VecEnv) -> RobotVecEnv:
    """Return the robots inside of wrappers, or raise TypeError."""
    robots = envs.unwrapped
    if not isinstance(robots, RobotVecEnv):
        raise TypeError(f"envs: expected a RobotVecEnv, wrapped or not, got {type(robots).__name__}")
    return robots
