"""Claims about strategies on several families at once: p-values and intervals that are corrected for their number.

Of many families some look different by chance. Holm's step-down method corrects the p-values: it keeps the probability
of a single wrong claim below 5 % however the families depend on each other (Holm 1979, "A simple sequentially rejective
multiple test procedure"). The corrected interval of each family is Bonferroni's, so that all of them hold together.

Shapes: S training seeds, K scenarios, V world seeds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats
from train.analysis.intervals import TAIL, Interval, Ratio

ANY_RATIO = (0.0, float("inf"))
"""The interval of a ratio of which nothing is known."""


@dataclass(frozen=True)
class Claim:
    """The ratio of two strategies' mean excess on one family."""

    family: str
    strategy: str
    against: str
    of: Ratio
    """The ratio, with the interval and the p-value that it has alone."""
    corrected: Interval
    """Joint interval with those of all other claims."""
    holm: float | None
    """p-value corrected for the number of claims; None for few scenarios."""

    @property
    def p(self) -> float | None:
        """The p-value that it has alone; None for few scenarios."""
        return self.of.p

    @property
    def ratio(self) -> float:
        """The ratio; infinite if the other strategy has no excess."""
        return np.inf if self.of.ratio is None else self.of.ratio

    @property
    def ci95(self) -> Interval:
        """The 95 % interval of this claim alone; without bounds if none is known."""
        return self.of.ci95 or ANY_RATIO


def claims_of(
    families: Mapping[str, Mapping[str, Floats]], strategies: Sequence[str], against: Mapping[str, str]
) -> list[Claim]:
    """Return one claim for each strategy and family.

    Args:
        families: family -> label -> excess costs (S, K, V), at least two scenarios.
        strategies: labels that all families have.
        against: family -> label of the strategy with which the others are compared.

    """
    ratios = {
        (family, label): Ratio.of(excesses[label].mean(axis=2), excesses[against[family]].mean(axis=(0, 2)))
        for family, excesses in families.items()
        for label in strategies
    }
    ps, tail = holm([1.0 if one.p is None else one.p for one in ratios.values()]), TAIL / max(len(ratios), 1)
    return [
        Claim(family, label, against[family], one, one.interval(tail) or ANY_RATIO, None if one.p is None else p)
        for ((family, label), one), p in zip(ratios.items(), ps, strict=True)
    ]


def holm(ps: Sequence[float]) -> list[float]:
    """Return p-values corrected by Holm's method, in the same order.

    >>> holm([0.01, 0.04, 0.03])
    [0.03, 0.06, 0.06]

    """
    order = np.argsort(ps, kind="stable")
    scaled = np.array(ps)[order] * np.arange(len(ps), 0, -1)
    corrected = np.empty(len(ps))
    corrected[order] = np.minimum(np.maximum.accumulate(scaled), 1.0)
    return [float(p) for p in corrected]
