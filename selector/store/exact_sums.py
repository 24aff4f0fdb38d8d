"""Exact sums of rewards as whole numbers on a fixed grid, so that the order of adding does not matter.

A reward is rounded once to the nearest multiple of 2^-24 (about 6e-8; halves to even). From then on count, sum and sum
of squares are whole numbers in units of 1, 2^-24 and 2^-48, and adding whole numbers is exact, commutative and
associative, which adding floats is not. Mean and variance are computed from the sums, each rounded once
(docs/decisions/0033-whole-number-store.md).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.registry import unknown

GRID_BITS = 24
"""A reward is a whole number of 2^-24."""
REWARD_LIMIT = 2.0**20
"""Largest absolute reward: about a million [-]. On the grid it takes 44 bits, which a float holds exactly."""
COUNT_LIMIT = 2**36
"""Most updates of one entry: the sum of squares stays below 2^(88 + 36), and that of the rewards below 2^80."""


@dataclass(frozen=True)
class Moments:
    """Count, sum and sum of squares of rewards, exactly.

    >>> (Moments(1, 1 << GRID_BITS, 1 << 2 * GRID_BITS) + Moments(1, 0, 0)).mean
    0.5

    Attributes:
        count: number of rewards.
        total: their sum in units of 2^-24.
        squares: the sum of their squares in units of 2^-48.

    """

    count: int
    total: int
    squares: int

    def __add__(self, other: Self) -> "Moments":
        """Return the moments of both sets of rewards together."""
        return Moments(self.count + other.count, self.total + other.total, self.squares + other.squares)

    @property
    def mean(self) -> float:
        """Mean reward, correctly rounded; undefined without rewards."""
        return self.total / (self.count << GRID_BITS)  # true division of whole numbers rounds once

    @property
    def variance(self) -> float:
        """Mean squared deviation from the mean, correctly rounded; 0 for a single reward."""
        deviations = self.count * self.squares - self.total**2
        return deviations / (self.count**2 << 2 * GRID_BITS)

    def impossible(self) -> str:
        """Return why no set of rewards has these moments; empty if one may have them."""
        largest = self.count * int(REWARD_LIMIT) << GRID_BITS
        if not 1 <= self.count <= COUNT_LIMIT:
            return f"expected a count from 1 to {COUNT_LIMIT}, got {self.count}"
        if abs(self.total) > largest:
            return f"expected a sum of at most {largest} either way for {self.count} rewards, got {self.total}"
        if not self.total**2 <= self.count * self.squares <= largest**2:
            return f"sum {self.total} and squares {self.squares} do not belong to {self.count} rewards"
        return ""


NO_REWARDS = Moments(0, 0, 0)
"""The moments of no reward."""


class RewardSums:
    """Exact sums of the rewards of one goal, for each option.

    The memory needed depends on the number of options, not on the number of rewards.

    >>> batch = RewardSums("AvoidCollision", ["near", "far"])
    >>> batch.record(np.array([0, 1, 1]), np.array([0.5, 1.0, 2.0]))
    >>> batch.moments["far"].mean
    1.5

    Args:
        goal: the goal that the options serve.
        options: (O,) names of the options, in the order in which a strategy numbers them.

    """

    def __init__(self, goal: str, options: Sequence[str]) -> None:
        self.goal = goal
        self.options = tuple(options)
        self.moments: dict[str, Moments] = {}
        """Sums by option; those that brought no reward are left out."""

    @property
    def count(self) -> int:
        """Number of rewards recorded."""
        return sum(moments.count for moments in self.moments.values())

    def record(self, option: Ints, reward: Floats) -> None:
        """Add `reward` (R,) of `option` (R,).

        Raises:
            ValueError: a reward is not finite or beyond a million, an option is unknown, or shapes do not fit; nothing
                is recorded then.

        """
        chosen, whole = self._checked_options(option), on_grid(reward)
        if whole.shape != chosen.shape:
            raise ValueError(f"reward: expected shape {chosen.shape}, got {whole.shape}")
        for k, value in zip(chosen.tolist(), whole.tolist(), strict=True):
            name = self.options[k]
            self.moments[name] = self.moments.get(name, NO_REWARDS) + Moments(1, value, value * value)

    def _checked_options(self, option: Ints) -> Ints:
        chosen = np.asarray(option)
        if chosen.ndim != 1 or not (np.issubdtype(chosen.dtype, np.integer) or chosen.size == 0):
            raise ValueError(f"option: expected integers (R,), got {chosen.shape} of {chosen.dtype}")
        outside = (chosen < 0) | (chosen >= len(self.options))
        if outside.any():
            raise ValueError(unknown("option", str(chosen[outside][0]), [str(k) for k in range(len(self.options))]))
        return chosen.astype(np.int64)


def on_grid(reward: Floats) -> Ints:
    """Return rewards (R,) as whole numbers (R,) of 2^-24; one that is not finite or too large raises ValueError."""
    values = np.asarray(reward, dtype=np.float64)
    wrong = ~(np.abs(values) <= REWARD_LIMIT)  # the comparison is false for NaN
    if wrong.any():
        row = int(np.argmax(wrong))
        limit = int(REWARD_LIMIT)
        raise ValueError(f"reward of row {row}: expected a number from -{limit} to {limit}, got {values[row]}")
    return np.rint(values * 2.0**GRID_BITS).astype(np.int64)
