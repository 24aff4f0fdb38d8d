"""Claims about strategies on several families at once: p-values and intervals that are corrected for their number.

Of many families some look different by chance. Holm's step-down method corrects the p-values: it keeps the probability
of a single wrong claim below 5 % however the families depend on each other (Holm 1979, "A simple sequentially rejective
multiple test procedure"). The corrected interval of each family is Bonferroni's, so that all of them hold together.

Far tails of a bootstrap are too short for few scenarios. Tails are therefore widened from the normal to Student's
distribution (Hesterberg 2015, doi:10.1080/00031305.2015.1089789).

Shapes: S training seeds, K scenarios, V world seeds, M claims, B resamples.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.stats

from selforg.arrays import Floats
from train.analysis.statistics import Interval
from train.analysis.strategy_comparison import Excesses, ratio_p

SIGNIFICANCE = 0.05
"""Probability of a wrong claim among all."""


@dataclass(frozen=True)
class Claim:
    """The ratio of two strategies' mean excess on one family."""

    family: str
    strategy: str
    against: str
    ratio: float
    ci95: Interval
    corrected: Interval
    """Interval that holds together with those of all other claims."""
    p: float
    holm: float
    """p-value corrected for the number of claims."""


def claims_of(
    families: Mapping[str, Mapping[str, Floats]], strategies: Sequence[str], against: Mapping[str, str]
) -> list[Claim]:
    """Return one claim for each strategy and family.

    Args:
        families: family -> label -> excess costs (S, K, V), at least two scenarios.
        strategies: labels that all families have.
        against: family -> label of what the strategies are compared with.

    """
    found = []
    for family, excesses in families.items():
        other = excesses[against[family]].mean(axis=(0, 2))
        for label in strategies:
            compared = Excesses(excesses[label].mean(axis=2), other, other)
            drawn = compared.resampled()
            found.append((family, label, float(compared.own.mean() / other.mean()), drawn[0] / drawn[1], len(other)))
    ps = [by_student(ratio_p(ratios) or 1.0, count) for *_, ratios, count in found]
    tail = SIGNIFICANCE / 2.0 / max(len(found), 1)
    return [
        Claim(
            family=family,
            strategy=label,
            against=against[family],
            ratio=ratio,
            ci95=_between(ratios, SIGNIFICANCE / 2.0, count),
            corrected=_between(ratios, tail, count),
            p=p,
            holm=corrected,
        )
        for (family, label, ratio, ratios, count), p, corrected in zip(found, ps, holm(ps), strict=True)
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


def by_student(p: float, count: int) -> float:
    """Return a two-sided p-value of a bootstrap over `count` scenarios, widened to Student's distribution."""
    normal = scipy.stats.norm.isf(p / 2.0) * np.sqrt((count - 1) / count)
    return float(min(2.0 * scipy.stats.t.sf(normal, count - 1), 1.0))


def _between(values: Floats, tail: float, count: int) -> Interval:
    """Return the interval of resampled `values` (B,) of which both tails have the probability `tail`."""
    student = scipy.stats.t.isf(tail, count - 1) * np.sqrt(count / (count - 1))
    own = float(scipy.stats.norm.sf(student))
    low, high = np.quantile(values, [own, 1.0 - own]).tolist()
    return low, high
