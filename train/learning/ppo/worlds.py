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

from clean_swarm_env.learning.actions import Mode
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.sb3 import RobotVecEnv
from train.deciders.decided_goal import DecidedGoal


class OneGoalEnv(VecEnvWrapper):
    """An environment whose actions are the option of one goal, a vector, or both in a row, the option first.

    Other goals keep the option of the highest score. The components of vectors lie within [-1, 1].
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

    A state has the components of all batches; those that a world lacks, as of robots and items beyond its own, are 0.

    Attributes:
        names: (G,) names of the components of a state.

    """

    def __init__(self, batches: Sequence[Batch]) -> None:
        self._batches, self._states = batches, [batch.global_state() for batch in batches]
        self.names = tuple(dict.fromkeys(name for state in self._states for name in state.names))
        column = {name: number for number, name in enumerate(self.names)}
        self._columns = [[column[name] for name in state.names] for state in self._states]
        envs = RobotVecEnv(batches=batches)
        highest = np.append(envs.observation_space.high, np.ones(len(self.names), np.float32))
        super().__init__(envs, observation_space=Box(-highest, highest, dtype=np.float32))

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
        """Return states (..., components of batch `number`) with zeros for the components that it lacks (..., G)."""
        filled = np.zeros((*states.shape[:-1], len(self.names)), dtype=np.float32)
        filled[..., self._columns[number]] = states
        return filled
