"""The worlds of a training as an environment of Stable-Baselines3.

Shapes: R rows (robots), F components of an observation, G components of the global state.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Discrete
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnvWrapper
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvObs, VecEnvStepReturn

from clean_swarm_env.borders.stable_baselines3 import RobotVecEnv
from clean_swarm_env.learning.actions import Mode
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.errors import DocumentError
from train.running.decided_goal import DecidedGoal


class OneGoalEnv(VecEnvWrapper):
    """An environment whose actions are the option of one goal, a vector, or both in a row, the option first.

    Other goals keep the option of the highest score.
    """

    def __init__(self, envs: VecEnv, goal: DecidedGoal, mode: Mode) -> None:
        count = len(goal.problem.options)
        highest = np.array([count - 1.0, 1.0, 1.0], dtype=np.float32)
        spaces = {
            "option": Discrete(count),
            "velocity": Box(-highest[1:], highest[1:]),
            "both": Box(np.array([0.0, -1.0, -1.0], dtype=np.float32), highest),
        }
        super().__init__(envs, action_space=spaces[mode])
        self._goal, self._mode = goal, mode

    def reset(self) -> VecEnvObs:
        """Begin all episodes."""
        return self.venv.reset()

    def step_async(self, actions: NDArray[Any]) -> None:
        """Send the action (R, ...) of each robot to the worlds."""
        if self._mode == "option":
            actions = self._goal.actions(actions)
        elif self._mode == "both":
            actions = np.hstack([self._goal.actions(actions[:, 0].astype(np.int64)), actions[:, 1:]])
        self.venv.step_async(actions)

    def step_wait(self) -> VecEnvStepReturn:
        """Return the results of the step."""
        return self.venv.step_wait()


class TeamEnv(VecEnvWrapper):
    """An environment in which the global state of its world follows the observation of each robot: (R, F + G).

    Raises:
        DocumentError: global states of the batches differ in their components.

    """

    def __init__(self, batches: Sequence[Batch]) -> None:
        self._batches, self._states = batches, [batch.global_state() for batch in batches]
        if len({state.names for state in self._states}) > 1:
            sizes = ", ".join(f"{b.robots} and {b.worlds.garbage.stage.shape[1]}" for b in batches)
            expected = "families of as many robots and items and with the same options"
            raise DocumentError(f"ppo: critic: expected {expected}, because it sees the state of all, got {sizes}")
        envs = RobotVecEnv(batches=batches)
        highest = np.append(envs.observation_space.high, np.ones(len(self._states[0].names), np.float32))
        super().__init__(envs, observation_space=Box(-highest, highest, dtype=np.float32))

    def reset(self) -> Observations:
        """Begin all episodes."""
        return self._followed(self.venv.reset())

    def step_wait(self) -> VecEnvStepReturn:
        """Return the results of the step."""
        observations, rewards, over, infos = self.venv.step_wait()
        first = 0
        for batch, state in zip(self._batches, self._states, strict=True):
            for end in batch.finished:
                for info in infos[first + end.world * batch.robots :][: batch.robots]:
                    info["terminal_observation"] = np.append(info["terminal_observation"], state.final[end.world])
            first += batch.rows
        return self._followed(observations), rewards, over, infos

    def _followed(self, observations: Observations) -> Observations:
        """Return observations (R, F) with the states of the worlds as they are behind them."""
        robots = [batch.robots for batch in self._batches]
        states = [np.repeat(state.now(), count, axis=0) for state, count in zip(self._states, robots, strict=True)]
        return np.hstack([observations, np.concatenate(states)])
