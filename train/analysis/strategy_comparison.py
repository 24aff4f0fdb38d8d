"""Comparison of strategies on one family: excess costs over scenarios and training seeds, between two yardsticks.

What is compared is the excess: the cost less what arrivals make unavoidable. The yardsticks are the best fixed option
and the oracle: the best fixed option of each scenario. Both are cross-fitted, so that luck does not count. The best
fixed option is chosen on one half of the scenarios and judged on the other, both ways round; the lowest of seven noisy
means would be lower than that of the option that is best. The oracle is chosen on other world seeds of the scenario
than that on which it is judged. It needs two world seeds or more
(docs/decisions/0213-best-fixed-on-halves.md).

The gap between the yardsticks is that of their means. It is told where sign flips tell it from 0
(`train.analysis.flips`). Ratios are of means. Intervals are by the number of scenarios, and of training seeds if there
are several (`train.analysis.intervals`).

Shapes: S training seeds, K scenarios, V world seeds of each, O fixed options.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from selforg.arrays import Floats, Ints
from train.analysis.flips import ALPHA, Flips
from train.analysis.intervals import Estimate, Ratio

ORACLE = "oracle"


@dataclass(frozen=True)
class StrategyStanding:
    """The results of one strategy."""

    label: str
    excess: Estimate
    """Mean excess cost [s]."""
    ratio: Ratio
    """Ratio of the mean excess to that of the best fixed option."""


@dataclass(frozen=True)
class BestFixed:
    """The best fixed option: chosen on one half of the scenarios, judged on the other."""

    labels: tuple[str, ...]
    """(2,) what the even scenarios are judged by, which the odd ones chose, then the other way round; equal or not."""

    @classmethod
    def of(cls, excesses: Mapping[str, Floats], fixed: Sequence[str]) -> BestFixed:
        """Choose among `fixed` by excess costs (S, K, V); the first of equals. A single scenario chooses for itself."""
        means = np.stack([excesses[label][0].mean(axis=1) for label in fixed])
        halves = means[:, 1::2] if means.shape[1] > 1 else means, means[:, ::2]
        return cls(tuple(fixed[int(half.mean(axis=1).argmin())] for half in halves))

    @cached_property
    def label(self) -> str:
        """The name of the option, or the names of both."""
        return " / ".join(dict.fromkeys(self.labels))

    def judged(self, excesses: Mapping[str, Floats]) -> Floats:
        """Return the excess costs (1, K, V): each scenario by the option that the other half chose."""
        even, odd = (excesses[label][:1] for label in self.labels)
        found = even.copy()
        found[:, 1::2] = odd[:, 1::2]
        return found


@dataclass(frozen=True)
class StrategyComparison:
    """All strategies on one family."""

    best_fixed: BestFixed
    gap: Estimate | None
    """Mean excess of the best fixed option less that of the oracle [s]; None with one world seed a scenario."""
    has_gap: bool
    """Whether the gap is told from 0."""
    standings: tuple[StrategyStanding, ...]
    """In the order given, the oracle last."""


def compare_strategies(
    excesses: Mapping[str, Floats], fixed: tuple[str, ...], left: Mapping[str, Floats] | None = None
) -> StrategyComparison:
    """Return the comparison of strategies by their excess costs (S, K, V).

    `fixed` names those that are one option each; at least one. `left`: label -> 1 where a mission was not completed.
    """
    best = BestFixed.of(excesses, fixed)
    yardstick, kept = best.judged(excesses), best.judged(left) if left else None
    compared, gap, has_gap = dict(excesses), None, False
    if yardstick.shape[2] > 1:
        compared[ORACLE] = cross_fitted(np.stack([excesses[label][0] for label in fixed]))[None, :, None]
        gaps = (yardstick - compared[ORACLE])[0].mean(axis=1)
        gap = Estimate.of(gaps[None])
        has_gap = gap.value > 0.0 and Flips(gaps).p < ALPHA
    lost = {label: (own, kept) for label, own in (left or {}).items() if kept is not None}
    standings = tuple(
        StrategyStanding(label, Estimate.of(own.mean(axis=2)), Ratio.of(own, yardstick, lost.get(label)))
        for label, own in compared.items()
    )
    return StrategyComparison(best, gap, has_gap, standings)


def cross_fitted(options: Floats) -> Floats:
    """Return the excess (K,) of the best option of each scenario, chosen on other world seeds than it is judged on.

    options: (O, K, V), V at least 2.

    >>> luck = np.array([[[1.0, 9.0]], [[9.0, 1.0]]])  # each option is good in one world of the scenario only
    >>> float(cross_fitted(luck)[0]), float(luck.min(axis=0).mean())
    (9.0, 1.0)

    """
    others = options.sum(axis=2, keepdims=True) - options
    chosen: Ints = others.argmin(axis=0)
    return np.asarray(np.take_along_axis(options, chosen[None], axis=0)[0].mean(axis=1))
