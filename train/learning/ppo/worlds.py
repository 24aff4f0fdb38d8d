"""The worlds of a training as an environment of Stable-Baselines3.

Shapes: R rows (robots), F components of an observation, G decided goals, O options of all these goals.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, MultiDiscrete
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnvWrapper
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvStepReturn

from clean_swarm_env.learning.joined import each_option
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.sb3 import RobotVecEnv
from selforg.arrays import Flags, Ints


class SelectorEnv(VecEnvWrapper):
    """Robots whose observations end with which options they can take; (R, F + O).

    Actions are an option of each decided goal. Other goals keep the option of the highest score. Options are kept for
    some decision periods: then no other can be taken.

    Args:
        envs: wraps `robots`.
        robots: the robots.
        holds: decided goal -> decision periods for which its options are kept.

    Attributes:
        options: decided goal -> names of its options.
        chosen: (R, G) where an option was chosen in the last period among several.
        taken, anew: (R, G) the options of the last period, and where they were not kept from the one before.
        over: (R,) whether the mission ended in the last period.

    """

    def __init__(self, envs: VecEnv, robots: RobotVecEnv, holds: Mapping[str, int]) -> None:
        self._robots = robots
        self.options = {goal: robots.options[goal] for goal in holds}
        self.counts = tuple(map(len, self.options.values()))
        order = each_option(robots.options)
        self._columns = [list(robots.options).index(goal) for goal in self.options]
        self._places = [order.index(option) for option in each_option(self.options)]
        self._holds = np.array([holds[goal] for goal in self.options], dtype=np.int64)
        self._defaults = robots.joined.defaults()
        self._left = np.zeros((robots.num_envs, len(self.counts)), dtype=np.int64)
        seen = envs.observation_space
        assert isinstance(seen, Box)
        flags = np.ones(len(self._places), np.float32)
        super().__init__(
            envs,
            Box(np.append(seen.low, -flags), np.append(seen.high, flags), dtype=np.float32),
            MultiDiscrete(list(self.counts)),
        )

    def reset(self) -> Observations:
        """Begin all episodes."""
        self._left[:] = 0
        return self._followed(self.venv.reset())

    def step_async(self, actions: NDArray[Any]) -> None:
        """Send the options (R, G) of the robots to the worlds."""
        self.taken = actions.astype(np.int64)
        self.anew = self._left == 0
        self._left = np.where(self._left == 0, self._holds, self._left) - 1
        whole = self._defaults.copy()
        whole[:, self._columns] = self.taken
        self.venv.step_async(whole)

    def step_wait(self) -> VecEnvStepReturn:
        """Return the results of the step."""
        seen, rewards, self.over, infos = self.venv.step_wait()
        several = [part.sum(axis=1) > 1 for part in np.split(self._masks, np.cumsum(self.counts)[:-1], axis=1)]
        self.chosen: Flags = np.stack(several, axis=1)
        self._left[self.over] = 0
        for row in np.flatnonzero(self.over).tolist():
            last = infos[row]["terminal_observation"]
            infos[row]["terminal_observation"] = np.append(last, np.ones(len(self._places), np.float32))
        return self._followed(seen), rewards, self.over, infos

    def _followed(self, seen: Observations) -> Observations:
        """Return observations (R, F) with what can be taken behind them."""
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
