"""Learners of a comparison that `clean-swarm train` does not have: PPO with a critic of the team, and from a network.

Shapes: W worlds, R rows (robots), F components of an observation, S components of the global state.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import torch
from gymnasium.spaces import Box
from numpy.typing import NDArray
from rich.console import Console
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.sb3 import RobotVecEnv
from selector.strategies.policy_file import TrainedPolicy, load_policy
from train.learning.ppo.networks import actor_layers
from train.learning.ppo.training import PpoTraining
from train.learning.session import run_training
from train.learning.training import TrainingJob
from train.request import Request


def learn(training: str, seed: int, output: Path, *, critic: str = "own", start: Path | None = None) -> None:
    """Do or continue a training by PPO; see `Trained` for the critic. `start` is the policy from which it starts."""
    request = Request(
        training, seed=seed, output=output, resume=True, words=("python", "-m", "docs.comparison.write_choosing")
    )
    made = partial(LearnerTraining, critic=critic, start=None if start is None else load_policy(start))
    run_training("ppo", request, made, Console(quiet=True))


class LearnerTraining(PpoTraining):
    """PPO whose critic may see the team (MAPPO: Yu et al. 2022, arXiv 2103.01955), and that may start from a policy."""

    def __init__(self, job: TrainingJob, *, critic: str, start: TrainedPolicy | None) -> None:
        self._critic, self._begun = critic, start
        super().__init__(job)

    def seen_by_critic(self) -> VecEnv:
        """Return the robots, with the states of their worlds behind what they observe if the critic sees the team."""
        return TeamEnv(self.robots) if self._critic == "team" else super().seen_by_critic()

    def _make(self) -> None:
        super()._make()
        if self._begun is not None:
            self._take(self._begun)

    def _take(self, policy: TrainedPolicy) -> None:
        """Take the weights and the statistics of a policy for the same options and observations."""
        given, own = policy.spec, self.policy().spec
        for name in ("goals", "observations", "hidden"):
            if getattr(given, name) != getattr(own, name):
                raise ConfigurationError(f"start: {name}: expected {getattr(own, name)}, got {getattr(given, name)}")
        with torch.no_grad():
            for name, weights in actor_layers(self.model):
                weights.copy_(torch.as_tensor(policy.weights[name]))
        width = len(given.observations)
        self._seen.mean[:width], self._seen.var[:width] = given.mean, given.variance
        self._seen.count = given.training["decisions"]


class TeamEnv(VecEnvWrapper):
    """An environment in which the global state of its world follows the observation of each robot: (R, F + S).

    A state has the components of all batches; those that a world lacks, as of robots and items beyond its own, are 0.
    """

    def __init__(self, robots: RobotVecEnv) -> None:
        self._batches, self._states = robots.batches, [batch.global_state() for batch in robots.batches]
        names = list(dict.fromkeys(name for state in self._states for name in state.names))
        column = {name: number for number, name in enumerate(names)}
        self._columns, self._width = [[column[name] for name in state.names] for state in self._states], len(names)
        highest = np.append(self._batches[0].observer.bounds, np.ones(len(names), np.float32))
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
        filled = np.zeros((*states.shape[:-1], self._width), dtype=np.float32)
        filled[..., self._columns[number]] = states
        return filled
