"""How far means over scenarios may be from the truth: intervals, p-values, and how many scenarios are needed.

Scenarios are drawn at random, and so are trainings where a strategy has several. Every interval and p-value is
therefore Student's, by the number of scenarios and trainings, however many missions were run. A ratio of means is taken
by its logarithm. docs/decisions/0212-ratios-by-student.md says how often intervals of ratios contain the truth.

Shapes: S trainings of a strategy, K scenarios.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import NormalDist
from typing import Final

import numpy as np

from selforg.arrays import Floats

Interval = tuple[float, float]
TAIL: Final = 0.025
"""Probability of each tail outside of a 95 % interval."""
FEWEST: Final = 6
"""Scenarios from which on there are p-values: five that all agree are no rarer than 6 % by chance alone."""
TOLD: Final = math.log(1.1)
"""Difference between two means, a tenth, that scenarios have to tell; as a logarithm."""
POWER: Final = 0.8
"""Probability that the recommended number of scenarios shows this difference."""
NO_SPREAD: Final = 1e-9
"""Errors of means below this one are roundings only."""


@dataclass(frozen=True)
class MeanError:
    """The error of a mean over scenarios and trainings."""

    scenarios: int
    error: float
    """Standard error."""
    freedom: float
    """Degrees of freedom, by Welch and Satterthwaite."""
    of_trainings: float = 0.0
    """The part of the trainings, which more scenarios do not lower; a standard error, too."""

    @classmethod
    def of(cls, values: Floats, other: Floats | None = None) -> MeanError | None:
        """Return that of the mean of `values` (S, K); None for a single scenario.

        `other` (S', K) has the values of another strategy in the same unit, whose mean over its trainings has been
        subtracted: these trainings count, too.
        """
        if values.shape[1] < 2:
            return None
        of_trainings = [values.mean(axis=1), *([] if other is None else [other.mean(axis=1)])]
        means = [own for own in (values.mean(axis=0), *of_trainings) if len(own) > 1]
        parts = np.array([own.var(ddof=1) / len(own) for own in means])
        shares = np.maximum(parts, NO_SPREAD**2) / np.maximum(parts, NO_SPREAD**2).sum()
        freedom = 1.0 / (shares**2 / [len(own) - 1 for own in means]).sum()
        return cls(values.shape[1], math.sqrt(parts.sum()), float(freedom), math.sqrt(parts[1:].sum()))

    def half_width(self, tail: float = TAIL) -> float:
        """Return half the width of the interval both of whose tails have the probability `tail`."""
        from scipy.special import stdtrit  # waits: processes of missions need no SciPy

        return -float(stdtrit(self.freedom, tail)) * self.error

    def around(self, mean: float) -> Interval:
        """Return the 95 % interval."""
        return mean - self.half_width(), mean + self.half_width()

    def p(self, mean: float) -> float | None:
        """Return the two-sided probability of a mean at least so far from 0 if it were 0; None for few scenarios."""
        if self.scenarios < FEWEST:
            return None
        from scipy.special import stdtr

        return 2.0 * float(stdtr(self.freedom, -abs(mean) / max(self.error, NO_SPREAD)))

    def needed(self, effect: float, tail: float = TAIL) -> int | None:
        """Return the number of scenarios that tells a mean of `effect` from 0, by this spread.

        None if no number does, because the trainings differ too much.
        """
        level, power = -NormalDist().inv_cdf(tail), NormalDist().inv_cdf(POWER)
        allowed = (effect / (level + power)) ** 2 - self.of_trainings**2
        variance = (self.error**2 - self.of_trainings**2) * self.scenarios
        return max(math.ceil(variance / allowed + level**2 / 2.0), FEWEST) if allowed > 0.0 else None


@dataclass(frozen=True)
class Ratio:
    """A ratio of two means over the same scenarios."""

    ratio: float | None
    """None if the denominator is zero."""
    spread: MeanError | None
    """That of its logarithm; None for a single scenario, or if a mean is zero."""
    scenarios: int

    @classmethod
    def of(cls, own: Floats, other: Floats) -> Ratio:
        """Return the ratio of the means of `own` (S, K) or (K,) and `other`, likewise."""
        own, other = np.atleast_2d(own), np.atleast_2d(other)
        above, below, count = float(own.mean()), float(other.mean()), other.shape[1]
        if below == 0.0 or above / below <= 0.0:
            return cls(above / below if below else None, None, count)
        return cls(above / below, MeanError.of(own / above - other.mean(axis=0) / below, other / below), count)

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

    @property
    def p(self) -> float | None:
        """Probability of a ratio at least so far from 1 if it were 1; None for fewer than FEWEST scenarios."""
        return self.spread.p(math.log(self.ratio)) if self.ratio is not None and self.spread is not None else None

    @property
    def content(self) -> dict[str, object]:
        """The ratio as JSON has it."""
        return {"ratio": self.ratio, "ci95": self.ci95, "p": self.p}


def too_few(ratios: Sequence[Ratio]) -> tuple[str, ...]:
    """Return the line that says how many scenarios `ratios` need, by the middle one of their spreads; none if enough.

    The ratio of the fewest scenarios counts.

    >>> too_few([Ratio.of(np.array([5.0, 3.0]), np.array([4.0, 4.0]))])
    ('2 scenarios: no statement; about 110 are needed to tell a difference of a tenth',)

    """
    scenarios = min((one.scenarios for one in ratios), default=FEWEST)
    if scenarios >= FEWEST:
        return ()
    spreads = [one.spread for one in ratios if one.spread is not None and one.spread.error > NO_SPREAD]
    found = [count for spread in spreads if (count := spread.needed(TOLD)) is not None]
    about = f"about {about_number(float(np.median(found)))}" if found else f"{FEWEST} or more"
    plural = "s" if scenarios != 1 else ""
    return (f"{scenarios} scenario{plural}: no statement; {about} are needed to tell a difference of a tenth",)


def about_number(count: float) -> int:
    """Return a count with two digits.

    >>> about_number(1234.0), about_number(7.0)
    (1200, 7)

    """
    return round(int(count), 2 - len(str(int(count))))
