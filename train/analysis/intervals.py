"""How far means over scenarios may be from the truth, whether two strategies differ, and how many scenarios tell it.

Scenarios are drawn at random, and so are trainings where a strategy has several. Every interval is therefore Student's,
by the number of scenarios and trainings, however many missions were run. A ratio of means is taken by its logarithm.
Whether two strategies differ is not told by an interval but by sign flips (`train.analysis.flips`).
docs/decisions/0212-sign-flips.md says how often intervals contain the truth, and how often equal strategies are told
apart.

Shapes: S trainings of a strategy, K scenarios, V worlds of each.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from selforg.arrays import Flags, Floats
from train.analysis.flips import TAIL, Flips, fewest, holm

Interval = tuple[float, float]
HEAVY: Final = 25.0
"""Squared skewness times this number is at most the number of scenarios if Student's interval is to keep its promise
(Cochran 1977, Sampling Techniques, 2.15)."""
TOLD: Final = math.log(1.1)
"""Difference between two means, a tenth, that scenarios have to tell; as a logarithm."""
NO_SPREAD: Final = 1e-9
"""Errors of means below this one are roundings only."""


@dataclass(frozen=True)
class MeanError:
    """The error of a mean over scenarios and trainings."""

    error: float
    """Standard error."""
    freedom: float
    """Degrees of freedom, by Welch and Satterthwaite."""

    @classmethod
    def of(cls, values: Floats, other: Floats | None = None) -> MeanError | None:
        """Return that of the mean of `values` (S, K); None for a single scenario.

        `other` (S', K) has the values of another strategy in the same unit, whose mean over its trainings has been
        subtracted: these trainings count, too.
        """
        if values.shape[1] < 2:
            return None
        of_trainings = [values.mean(axis=1), *([] if other is None else [other.mean(axis=1)])]
        parts, freedom = welch([values.mean(axis=0), *of_trainings])
        return cls(math.sqrt(parts.sum()), freedom)

    def half_width(self, tail: float = TAIL) -> float:
        """Return half the width of the interval both of whose tails have the probability `tail`."""
        from scipy.special import stdtrit  # waits: processes of missions need no SciPy

        return -float(stdtrit(self.freedom, tail)) * self.error


def welch(means: Sequence[Floats]) -> tuple[Floats, float]:
    """Return the squared errors of the means of independent samples with two values or more, and their freedom."""
    known = [own for own in means if len(own) > 1]
    parts = np.array([own.var(ddof=1) / len(own) for own in known])
    shares = np.maximum(parts, NO_SPREAD**2) / np.maximum(parts, NO_SPREAD**2).sum()
    return parts, float(1.0 / (shares**2 / [len(own) - 1 for own in known]).sum()) if known else 1.0


def share_interval(share: float, scenarios: int, tail: float = TAIL) -> Interval:
    """Return the interval (Clopper and Pearson's) of a share over scenarios, each of which may be a mean over members.

    >>> low, high = share_interval(0.0, 30)
    >>> low, round(high, 3)
    (0.0, 0.116)

    """
    from scipy.special import betaincinv  # waits: processes of missions need no SciPy

    hits = share * scenarios
    misses = scenarios - hits
    below = float(betaincinv(hits, misses + 1.0, tail)) if hits else 0.0
    return below, float(betaincinv(hits + 1.0, misses, 1.0 - tail)) if misses else 1.0


def heavy_tailed(values: Floats) -> bool:
    """Return whether some values (K,) are so far out that Student's interval of the mean is too narrow.

    A skewness that as many normal values have in one of twenty samples is no sign of it.

    >>> heavy_tailed(np.r_[np.arange(29.0), 500.0]), heavy_tailed(np.arange(30.0))
    (True, False)

    """
    away, count = values - values.mean(), len(values)
    spread = float(np.mean(away**2))
    skewness = float(np.mean(away**3)) / spread**1.5 if spread > NO_SPREAD**2 else 0.0
    return skewness**2 > max(count / HEAVY, 4.0 * 6.0 / count)


@dataclass(frozen=True)
class Estimate:
    """A figure and its interval."""

    value: float
    ci95: Interval | None

    @classmethod
    def of(cls, values: Floats) -> Estimate:
        """Return the mean of `values` (S, K) with its interval."""
        mean, spread = float(values.mean()), MeanError.of(values)
        return cls(mean, None if spread is None else (mean - spread.half_width(), mean + spread.half_width()))

    @classmethod
    def of_amounts(cls, values: Floats) -> Estimate:
        """Return the same with an interval that begins at 0 where no value is less, as no cost or time is."""
        mean = cls.of(values)
        if mean.ci95 is None or values.min() < 0.0:
            return mean
        return cls(mean.value, (max(mean.ci95[0], 0.0), mean.ci95[1]))


@dataclass(frozen=True)
class Ratio:
    """A ratio of two means over the same scenarios, and whether the strategies differ."""

    ratio: float | None
    """None if the denominator is zero."""
    spread: MeanError | None
    """That of its logarithm; None for a single scenario, or if a mean is zero."""
    scenarios: int
    tests: tuple[Flips, ...]
    """That of the costs of missions that both finish, and of the shares of unfinished ones."""
    sign: float
    """Sign of the difference of the means; a test of the other sign tells nothing."""

    @classmethod
    def of(cls, own: Floats, other: Floats, left: tuple[Floats, Floats] | None = None) -> Ratio:
        """Return the ratio of the means of `own` (K,), (S, K) or (S, K, V) and `other`, likewise.

        `left` has 1 for each unfinished mission of both, else 0, in the same shapes.
        """
        both = cells(own), cells(other)
        tests = _tests(*both, None if left is None else (cells(left[0]), cells(left[1])))
        own, other = (each.mean(axis=2) for each in both)
        above, below, count = float(own.mean()), float(other.mean()), other.shape[1]
        ratio, sign = above / below if below else None, float(np.sign(above - below))
        if ratio is None or ratio <= 0.0:
            return cls(ratio, None, count, tests, sign)
        spread = MeanError.of(own / above - other.mean(axis=0) / below, other / below)
        return cls(ratio, spread, count, tests, sign)

    @classmethod
    def between(cls, label: str, to: str, values: Mapping[str, Floats], left: Mapping[str, Floats] | None) -> Ratio:
        """Return the ratio of the means of two labels of a table; `left` likewise, or nothing; see `of`."""
        return cls.of(values[label], values[to], (left[label], left[to]) if left else None)

    def interval(self, tail: float = TAIL) -> Interval | None:
        """Return the interval both of whose tails have the probability `tail`; None if it is unknown."""
        if self.ratio is None or self.spread is None:
            return None
        half = min(self.spread.half_width(tail), 500.0)
        return self.ratio * math.exp(-half), self.ratio * math.exp(half)

    @cached_property
    def ci95(self) -> Interval | None:
        """The 95 % interval."""
        return self.interval()

    @cached_property
    def p(self) -> float | None:
        """Probability of such a difference between equal strategies, of this comparison alone; see `corrected_ps`."""
        return corrected_ps([self])[0]

    @property
    def content(self) -> dict[str, object]:
        """The ratio as JSON has it."""
        return {"ratio": self.ratio, "ci95": self.ci95, "p": self.p}


def cells(values: Floats) -> Floats:
    """Return values as (S, K, V)."""
    return values[None, :, None] if values.ndim == 1 else values.reshape(*values.shape[:2], -1)


def _tests(own: Floats, other: Floats, left: tuple[Floats, Floats] | None) -> tuple[Flips, ...]:
    """Return the test of the figures of missions (S, K, V), and that of the shares of unfinished ones."""
    mine, theirs = own[:, None], other[None]
    if left is None:
        finished = np.broadcast_to(True, np.broadcast_shapes(mine.shape, theirs.shape))
    else:
        finished = (left[0][:, None] == 0.0) & (left[1][None] == 0.0)
    positive = bool(np.minimum(mine, theirs)[finished].min(initial=np.inf) > 0.0)
    if positive:
        mine, theirs = (np.log(each, where=each > 0.0, out=np.zeros_like(each)) for each in (mine, theirs))
    shares = [] if left is None else [_flips(left[0][:, None] - left[1][None], np.ones_like(finished), False)]
    return _flips(mine - theirs, finished, positive), *shares


def _flips(differences: Floats, counted: Flags, logarithms: bool) -> Flips:
    """Return the test of those differences (S, S', K, V) that are counted."""
    found = np.ma.masked_array(differences, ~counted)
    parts, freedom = welch([found.mean(axis=rest).compressed() for rest in ((1, 2, 3), (0, 2, 3))])
    return Flips(found.mean(axis=(0, 1, 3)).compressed(), math.sqrt(parts.sum()), freedom, logarithms)


def corrected_ps(ratios: Sequence[Ratio]) -> list[float | None]:
    """Return the p-value of each of the comparisons of a table, corrected for their number.

    None where the scenarios do not allow a statement.
    """
    enough = [one.scenarios >= fewest(len(ratios)) for one in ratios]
    tests = [(k, test) for k, one in enumerate(ratios) for test in one.tests if any(enough)]
    corrected = holm([test.p for _, test in tests], [test.least for _, test in tests])
    found = [1.0] * len(ratios)
    for (k, test), p in zip(tests, corrected, strict=True):
        if test.sign == ratios[k].sign:
            found[k] = min(found[k], p)
    return [p if known else None for p, known in zip(found, enough, strict=True)]


def about_number(count: float) -> int:
    """Return a count with two digits.

    >>> about_number(1234.0), about_number(7.0)
    (1200, 7)

    """
    return round(int(count), 2 - len(str(int(count))))
