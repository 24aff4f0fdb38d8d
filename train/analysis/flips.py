"""Sign flips: the test that tells strategies apart, and its correction for the number of comparisons.

Where two strategies are alike, chance alone decides which of them has the larger figure in a scenario: each difference
could as well have the other sign. The p-value is the share of all ways to flip signs whose sum is at least as far from
zero as the one that was found. For shares of unfinished missions this is McNemar's exact test. Nothing is supposed of
how costs are distributed; docs/decisions/0212-sign-flips.md has the simulation.

Shapes: P comparisons, K scenarios, F flips.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from statistics import NormalDist
from typing import Final

import numpy as np

from selforg.arrays import Floats

ALPHA: Final = 0.05
"""Probability of a single wrong statement in a table of equal strategies."""
TAIL: Final = 0.025
"""Probability of each tail outside of a 95 % interval."""
POWER: Final = 0.8
"""Probability that the recommended number of scenarios shows a difference."""
FLIPS: Final = 2**15
"""Most flips: all there are for up to 16 scenarios that differ, else as many that are drawn."""
MOST_SUMS: Final = 2**23
"""Most sums that are held in memory at once."""
ROUNDING: Final = 1e-9
"""Share of the sum of all differences by which equal sums may differ."""


@dataclass(frozen=True)
class Flips:
    """The differences of two strategies in the scenarios in which both can be compared."""

    differences: Floats
    """(K,) own figure minus the other's; logarithms where the figures are costs."""
    error: float = 0.0
    """Standard error that trainings add to the mean of the differences."""
    freedom: float = 1.0
    """Its degrees of freedom."""
    logarithms: bool = False
    """Whether the differences are those of logarithms."""

    @cached_property
    def p(self) -> float:
        """The two-sided p-value; that of several trainings supposes that these are normal."""
        return float(flip_ps(self.differences[None], self.error * len(self.differences), self.freedom)[0])

    @property
    def least(self) -> float:
        """A bound below which no signs of these differences bring the p-value."""
        count = int(np.count_nonzero(self.differences))
        return max(0.5 ** max(count - 1, 0), 1.0 / (FLIPS + 1))

    @property
    def sign(self) -> float:
        """Return 1 if the own figure is larger, -1 if it is lower, else 0."""
        return float(np.sign(self.differences.sum()))

    @property
    def spread(self) -> float:
        """Standard deviation of the differences of logarithms; 0 if it is unknown."""
        return float(self.differences.std(ddof=1)) if self.logarithms and len(self.differences) > 1 else 0.0

    def needed(self, effect: float, tail: float = TAIL) -> int | None:
        """Return the number of scenarios that tells logarithms that differ by `effect`, by this spread.

        None if no number does, because the trainings differ too much.
        """
        level, power = -NormalDist().inv_cdf(tail), NormalDist().inv_cdf(POWER)
        allowed = (effect / (level + power)) ** 2 - self.error**2
        return max(math.ceil(self.spread**2 / allowed + level**2 / 2.0), fewest(1)) if allowed > 0.0 else None


def flip_ps(differences: Floats, error: float = 0.0, freedom: float = 1.0, flips: int = FLIPS) -> Floats:
    """Return the p-value of each row of `differences` (P, K); `error` is that of a row's sum."""
    from scipy.special import stdtr  # waits: processes of missions need no SciPy

    counts, ps = np.count_nonzero(differences, axis=1), np.ones(len(differences))
    order = np.argsort(differences == 0.0, axis=1, kind="stable")
    packed = np.take_along_axis(differences, order, axis=1)
    for count in np.unique(counts[counts > 0]).tolist():
        signs, every = _signs(count, flips), np.flatnonzero(counts == count)
        drawn = float(len(signs) < 2 ** (count - 1))
        for rows in np.array_split(every, -(-len(every) * len(signs) // MOST_SUMS)):
            own = packed[rows, :count]
            sums, found = own @ signs.T, np.abs(own.sum(axis=1, keepdims=True))
            if error > 0.0:
                hits = stdtr(freedom, (-found - sums) / error) + stdtr(freedom, (sums - found) / error)
            else:
                hits = np.abs(sums) >= found - ROUNDING * np.abs(own).sum(axis=1, keepdims=True)
            ps[rows] = (hits.sum(axis=1) + drawn) / (len(signs) + drawn)
    return ps


@lru_cache(maxsize=4)
def _signs(count: int, flips: int) -> Floats:
    """Return signs (F, K): all of which the last is 1, as the others mirror them, or as many as are drawn."""
    if 2 ** (count - 1) <= flips:
        bits = (np.arange(2 ** (count - 1))[:, None] >> np.arange(count)) & 1
    else:
        bits = np.random.default_rng(count).integers(0, 2, (flips, count))
    return np.where(bits, -1.0, 1.0)


def holm(ps: Sequence[float], least: Sequence[float] = ()) -> list[float]:
    """Return p-values corrected by Holm's method, in the same order.

    `least` has the bound of each. Tests that no outcome could have made significant do not count (Tarone 1990,
    doi:10.2307/2531456); their corrected p-value is 1.

    >>> holm([0.01, 0.04, 0.03])
    [0.03, 0.06, 0.06]
    >>> holm([0.01, 1.0], [0.001, 1.0])
    [0.01, 1.0]

    """
    bounds = np.array(least or [0.0] * len(ps))
    counted = next((k for k in range(1, len(ps) + 1) if (bounds * k <= ALPHA).sum() <= k), 1)
    able = np.flatnonzero(bounds * counted <= ALPHA)
    order = able[np.argsort(np.array(ps)[able], kind="stable")]
    corrected = np.ones(len(ps))
    corrected[order] = np.minimum(np.maximum.accumulate(np.array(ps)[order] * np.arange(len(order), 0, -1)), 1.0)
    return [float(p) for p in corrected]


def fewest(tests: int) -> int:
    """Return the fewest scenarios with which a comparison can be significant; `tests`: comparisons of the table.

    >>> fewest(1), fewest(15)  # two strategies, six strategies
    (6, 10)

    """
    return math.ceil(math.log2(max(tests, 1) / ALPHA) + 1.0)
