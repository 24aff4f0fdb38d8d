"""Rollouts of robots that come and go, and whose decisions have no effect at times.

Only decisions that count are learned from, and of each only the goals whose options had an effect. What a robot is
paid until its next decision that counts belongs to the one before, each period by the discount more: a semi-Markov
decision process (Sutton, Precup & Singh 1999, doi:10.1016/S0004-3702(99)00052-1). The loss of PPO is that of
Stable-Baselines3.
docs/decisions/0215-decisions-that-count.md has what it brings.

Shapes: T periods of a rollout, R rows (robots), G goals, O options of all goals.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.type_aliases import RolloutBufferSamples

from selforg.arrays import Flags
from train.learning.ppo.worlds import keep_only

WAITING = ("observations", "actions", "values", "log_probs")
"""Arrays of a decision that waits."""


class RobotRollouts(RolloutBuffer):
    """A rollout buffer (T + 1, R) whose first place has the decisions that waited for what came of them.

    The last decision of a row that counts waits for the next rollout, unless the episode ends or the robot stops
    working: it is compared with the value of the next one, not with that of a state in which nothing is decided.

    Args:
        steps: T.
        *spaces: of observations and actions.
        deciding: returns which rows (R,) have a robot that decides now.
        effective: returns for which goals (R, G) an option was chosen that had an effect in the last period.
        parts: returns the logarithms of the probabilities (R, G) with which the options were chosen.
        counts: (G,) number of options of each goal.
        **settings: of the base class.

    Attributes:
        deciding: (R,) rows that made the decisions of the present period.
        counted: (T + 1, R) decisions that count.
        known: (T + 1, R) those of them of which is known what came of them.

    """

    generator_ready: bool

    def __init__(
        self,
        steps: int,
        *spaces: Any,  # noqa: ANN401  (of the base class)
        deciding: Callable[[], Flags],
        effective: Callable[[], Flags],
        parts: Callable[[], torch.Tensor],
        counts: Sequence[int],
        **settings: Any,  # noqa: ANN401
    ) -> None:
        self._now, self._effective, self._parts, self._counts = deciding, effective, parts, counts
        self._waiting: dict[str, NDArray[Any]] = {}
        super().__init__(steps + 1, *spaces, **settings)
        self._waited = np.ones(self.n_envs)  # discount of the time for which decisions have waited

    def reset(self) -> None:
        """Begin a rollout with the decisions that wait."""
        super().reset()
        shape = (self.buffer_size, self.n_envs)
        self.counted, self.known, self._there = (np.zeros(shape, dtype=np.bool_) for _ in range(3))
        for name, waiting in self._waiting.items():
            getattr(self, name)[0] = waiting
        self.pos, self.deciding = 1, self._now()

    def add(self, seen: NDArray[Any], actions: NDArray[Any], *step: Any) -> None:  # noqa: ANN401  (of the base class)
        """Add a period that has just passed.

        Where the option of a goal had no effect, no other is possible afterwards: its probability is 1.
        """
        effective, (*others, chances), seen = self._effective(), step, seen.copy()
        self._there[self.pos], self.counted[self.pos] = self.deciding, self.deciding & effective.any(axis=1)
        keep_only(seen[:, -sum(self._counts) :], self._counts, actions.astype(np.int64), ~effective)
        without = (self._parts() * torch.as_tensor(~effective)).sum(dim=1)
        super().add(seen, actions, *others, chances - without)
        self.deciding = self._now()

    def compute_returns_and_advantage(self, last_values: torch.Tensor, dones: NDArray[np.bool_]) -> None:
        """Compute returns and advantages (GAE) of the decisions that count, and keep those that wait."""
        begins = np.vstack([self.episode_starts, dones]) > 0.0
        goes_on = np.vstack([self._there, self.deciding]) & ~begins
        self.counted[0] &= goes_on[1]  # all worlds may have begun anew
        worth, trace, last = np.zeros(self.n_envs), np.zeros(self.n_envs), np.full(self.n_envs, -1)
        waits = np.ones(self.n_envs, dtype=np.bool_)
        for step in reversed(range(self.buffer_size)):
            counts, discount = self.counted[step], (self.gamma if step else self._waited) * goes_on[step + 1]
            waits &= goes_on[step + 1]
            gain = self.rewards[step] + discount * worth
            self.advantages[step] = gain + discount * trace - self.values[step]
            self.known[step] = counts & ~waits
            self.rewards[step] = gain
            last[counts & waits] = step
            worth = np.where(counts, self.values[step], gain)
            trace = np.where(counts, self.gae_lambda * self.advantages[step] * ~waits, discount * trace)
            waits &= ~counts
        self.returns = self.advantages + self.values
        self._keep(last)

    def _keep(self, last: NDArray[np.int64]) -> None:
        """Keep the decisions (R,) that wait, at the places `last` (R,), -1 for none."""
        rows, place = np.arange(self.n_envs), np.maximum(last, 0)
        kept = {name: getattr(self, name)[place, rows] for name in (*WAITING, "rewards")}
        self._waited = self.gamma ** (self.buffer_size - np.maximum(place, 1)) * np.where(place == 0, self._waited, 1.0)
        self._waiting = {**kept, "counted": last >= 0}

    def get(self, batch_size: int | None = None) -> Iterator[RolloutBufferSamples]:
        """Yield the decisions whose results are known, in a random order."""
        if not self.generator_ready:
            chosen = self.swap_and_flatten(self.known)[:, 0]
            for name in (*WAITING, "advantages", "returns"):
                setattr(self, name, self.swap_and_flatten(getattr(self, name))[chosen])
            self.generator_ready = True
        order = np.random.permutation(len(self.values))  # noqa: NPY002  (as the base class, whose seed is set)
        for first in range(0, len(order), batch_size or len(order)):
            yield self._get_samples(order[first : first + (batch_size or len(order))])


class RobotPPO(PPO):
    """PPO that learns nothing from a rollout in which no decision counted."""

    rollout_buffer: RobotRollouts

    def train(self) -> None:
        """Update the network."""
        if self.rollout_buffer.known.any():
            super().train()


class MomentsOfRobots(RunningMeanStd):
    """Mean and variance (`shape`) of the rows that `which` returns (R,): rows without a robot hold zeros."""

    def __init__(self, which: Callable[[], Flags], shape: tuple[int, ...] = ()) -> None:
        super().__init__(shape=shape)
        self._which = which

    def update(self, arr: NDArray[np.float64]) -> None:
        """Learn of rows (R, ...)."""
        rows = self._which()
        if rows.any():
            super().update(arr[rows])
