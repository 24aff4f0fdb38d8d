"""The worlds of a training as an environment of Stable-Baselines3.

Shapes: R rows (robots), F components of an observation, S components of the global state, G decided goals, O options of
all these goals.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, MultiDiscrete
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnvWrapper
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvStepReturn

from clean_swarm_env.borders.spaces import observation_space
from clean_swarm_env.learning.actions import Mode
from clean_swarm_env.learning.joined import each_option
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.sb3 import RobotVecEnv
from selforg.arrays import Flags, Ints


class SelectorEnv(VecEnvWrapper):
    """Robots whose observations end with which options they can take; (R, F + O).

    Actions are an option of each decided goal, a vector, or both in a row, options first. Other goals keep the option
    of the highest score. Options are kept for some decision periods: then no other can be taken. The components of
    vectors lie within [-1, 1].

    Args:
        envs: wraps `robots`.
        robots: the robots.
        holds: decided goal -> decision periods for which its options are kept.
        mode: what actions are.

    Attributes:
        options: decided goal -> names of its options.
        chosen: (R, G) where an option was chosen in the last period among several.
        taken, anew: (R, G) the options of the last period, and where they were not kept from the one before.
        over: (R,) whether the mission ended in the last period.

    """

    def __init__(self, envs: VecEnv, robots: RobotVecEnv, holds: Mapping[str, int], mode: Mode) -> None:
        self._robots, self._mode = robots, mode
        self.options = {goal: robots.options[goal] for goal in (() if mode == "velocity" else holds)}
        self.counts = tuple(map(len, self.options.values()))
        order = each_option(robots.options)
        self._columns = [list(robots.options).index(goal) for goal in self.options]
        self._places = [order.index(option) for option in each_option(self.options)]
        self._holds = np.array([holds[goal] for goal in self.options], dtype=np.int64)
        self._defaults = robots.default_options() if self.options else np.zeros((robots.num_envs, 0), dtype=np.int64)
        self._left = np.zeros((robots.num_envs, len(self.counts)), dtype=np.int64)
        self._masks = np.zeros((robots.num_envs, len(self._places)), dtype=np.bool_)
        self.chosen = self.anew = self._left > 0
        self.taken = self._left
        highest = np.array([*(count - 1.0 for count in self.counts), 1.0, 1.0], dtype=np.float32)
        lowest = np.array([*(0.0 for _ in self.counts), -1.0, -1.0], dtype=np.float32)
        seen = envs.observation_space
        assert isinstance(seen, Box)
        flags = np.ones(len(self._places), np.float32)
        super().__init__(
            envs,
            Box(np.append(seen.low, -flags), np.append(seen.high, flags), dtype=np.float32),
            MultiDiscrete(list(self.counts)) if mode == "option" else Box(lowest, highest),
        )

    def reset(self) -> Observations:
        """Begin all episodes."""
        self._left[:] = 0
        return self._followed(self.venv.reset())

    def step_async(self, actions: NDArray[Any]) -> None:
        """Send the action (R, ...) of each robot to the worlds."""
        if self._mode == "velocity":
            self.venv.step_async(actions)
            return
        self.taken = actions[:, : len(self.counts)].astype(np.int64)
        self.anew = self._left == 0
        self._left = np.where(self._left == 0, self._holds, self._left) - 1
        whole = self._defaults.copy()
        whole[:, self._columns] = self.taken
        self.venv.step_async(np.hstack([whole, actions[:, len(self.counts) :]]) if self._mode == "both" else whole)

    def step_wait(self) -> VecEnvStepReturn:
        """Return the results of the step."""
        seen, rewards, self.over, infos = self.venv.step_wait()
        several = [part.sum(axis=1) > 1 for part in np.split(self._masks, np.cumsum(self.counts)[:-1], axis=1)]
        self.chosen = np.stack(several, axis=1) if self.counts else self.chosen
        self._left[self.over] = 0
        for row in np.flatnonzero(self.over).tolist():
            last = infos[row]["terminal_observation"]
            infos[row]["terminal_observation"] = np.append(last, np.ones(len(self._places), np.float32))
        return self._followed(seen), rewards, self.over, infos

    def _followed(self, seen: Observations) -> Observations:
        """Return observations (R, F) with what can be taken behind them."""
        if not self.counts:
            return seen
        self._masks = self._robots.action_masks()[:, self._places]
        if self._left.any():
            keep_only(self._masks, self.counts, self.taken, self._left > 0)
        return np.hstack([seen, self._masks.astype(np.float32)])


def keep_only(masks: NDArray[Any], counts: Sequence[int], options: Ints, where: Flags) -> None:
    """Leave in `masks` (R, O) only the `options` (R, G) that were taken, for the goals and rows `where` (R, G)."""
    for k, own in enumerate(np.split(masks, np.cumsum(counts)[:-1], axis=1)):
        rows = np.flatnonzero(where[:, k])
        own[rows] = 0
        own[rows, options[rows, k]] = 1


class TeamEnv(VecEnvWrapper):
    """An environment in which the global state of its world follows the observation of each robot: (R, F + S).

    A state has the components of all batches; those that a world lacks, as of robots and items beyond its own, are 0.

    Attributes:
        names: (S,) names of the components of a state.

    """

    def __init__(self, robots: RobotVecEnv) -> None:
        self._batches, self._states = robots.batches, [batch.global_state() for batch in robots.batches]
        self.names = tuple(dict.fromkeys(name for state in self._states for name in state.names))
        column = {name: number for number, name in enumerate(self.names)}
        self._columns = [[column[name] for name in state.names] for state in self._states]
        highest = np.append(observation_space(robots.batches[0]).high, np.ones(len(self.names), np.float32))
        super().__init__(robots, observation_space=Box(-highest, highest, dtype=np.float32))

    def reset(self) -> Observations:
        """Begin all episodes."""
        return self._followed(self.venv.reset())

    def step_wait(self) -> VecEnvStepReturn:
        """Return the results of the step."""
        observations, rewards, over, infos = self.venv.step_wait()
        first = 0
        for number, batch in enumerate(self._batches):
            for end in batch.finished:
                final = self._filled(number, self._states[number].final[end.world])
                for info in infos[first + end.world * batch.robots :][: batch.robots]:
                    info["terminal_observation"] = np.append(info["terminal_observation"], final)
            first += batch.rows
        return self._followed(observations), rewards, over, infos

    def _followed(self, observations: Observations) -> Observations:
        """Return observations (R, F) with the states of the worlds as they are behind them."""
        states = [
            np.repeat(self._filled(number, state.now()), self._batches[number].robots, axis=0)
            for number, state in enumerate(self._states)
        ]
        return np.hstack([observations, np.concatenate(states)])

    def _filled(self, number: int, states: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return states (..., components of batch `number`) with zeros for the components that it lacks (..., S)."""
        filled = np.zeros((*states.shape[:-1], len(self.names)), dtype=np.float32)
        filled[..., self._columns[number]] = states
        return filled
