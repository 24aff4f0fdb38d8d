"""Claims about strategies on several families at once: p-values and intervals that are corrected for their number.

Of many families some look different by chance. Holm's step-down method corrects the p-values of sign flips: it keeps
the probability of a single wrong claim below 5 % however the families depend on each other (Holm 1979, "A simple
sequentially rejective multiple test procedure"). The corrected interval of each family is Bonferroni's, so that all of
them hold together.

Shapes: S training seeds, K scenarios, V world seeds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats
from train.analysis.flips import TAIL
from train.analysis.intervals import Interval, Ratio, corrected_ps

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
    def ratio(self) -> float:
        """The ratio; infinite if the other strategy has no excess."""
        return np.inf if self.of.ratio is None else self.of.ratio

    @property
    def ci95(self) -> Interval:
        """The 95 % interval of this claim alone; without bounds if none is known."""
        return self.of.ci95 or ANY_RATIO


def claims_of(
    asked: Sequence[tuple[str, str, str]],
    families: Mapping[str, Mapping[str, Floats]],
    left: Mapping[str, Mapping[str, Floats]] | None = None,
) -> list[Claim]:
    """Return one claim for each comparison.

    Args:
        asked: family, label, and label of the strategy with which it is compared.
        families: family -> label -> excess costs (S, K, V), at least two scenarios.
        left: family -> label -> 1 where a mission was not completed (S, K, V); nothing where that means nothing.

    """
    ratios = [
        Ratio.between(label, against, families[family], (left or {}).get(family)) for family, label, against in asked
    ]
    ps, tail = corrected_ps(ratios), TAIL / max(len(ratios), 1)
    return [
        Claim(*names, one, one.interval(tail) or ANY_RATIO, p) for names, one, p in zip(asked, ratios, ps, strict=True)
    ]


def interval_cell(ci95: tuple[float, float] | None, digits: int = 3) -> str:
    """Return a 95 % interval; empty if there is none."""
    return "" if ci95 is None else "[{}, {}]".format(*(f"{x:.{digits}f}" if x < 1e5 else f"{x:.1g}" for x in ci95))
