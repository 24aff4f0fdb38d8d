"""Comparison of strategies on one family: excess costs over scenarios and training seeds, between two yardsticks.

What is compared is the excess: the cost less what arrivals make unavoidable. The yardsticks are the single best fixed
option (that of the lowest mean on these very scenarios) and the oracle: the best fixed option of each scenario. The
oracle is cross-fitted: the option is chosen on other world seeds of the scenario than that on which it is judged, so
that luck does not count. It needs two world seeds or more.

The share of the gap between the yardsticks that a strategy closes is (best fixed - strategy) / (best fixed - oracle) of
means; above 1 the strategy is better than every choice of one option for each scenario. There is a gap where its
interval excludes 0. Ratios are of means; intervals are bootstraps that draw scenarios, the same for both sides, and
training seeds if there are several.

Shapes: S training seeds, K scenarios, V world seeds of each, O fixed options, B resamples.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats, Ints
from train.analysis.statistics import Interval, interval, resampled

COMPARISON_RESAMPLES = 10_000
"""Bootstrap resamples of a comparison."""
ORACLE = "oracle"


@dataclass(frozen=True)
class Estimate:
    """A figure and its interval."""

    value: float
    ci95: Interval | None


@dataclass(frozen=True)
class StrategyStanding:
    """The results of one strategy."""

    label: str
    excess: Estimate
    """Mean excess cost [s]."""
    ratio: Estimate
    """Ratio of the mean excess to that of the best fixed option."""
    p: float | None
    """Probability, by the same bootstrap, of a ratio at least so far from 1 if it were 1; None without an interval."""
    share: Estimate | None
    """Share of the gap that the strategy closes; None without a gap."""


@dataclass(frozen=True)
class StrategyComparison:
    """All strategies on one family."""

    best_fixed: str
    gap: Estimate | None
    """Mean excess of the best fixed option less that of the oracle [s]; None with one world seed a scenario."""
    standings: tuple[StrategyStanding, ...]
    """In the order given, the oracle last."""

    @property
    def has_gap(self) -> bool:
        """Whether the interval of the gap excludes 0."""
        return self.gap is not None and self.gap.ci95 is not None and self.gap.ci95[0] > 0.0


@dataclass(frozen=True)
class Excesses:
    """Excess costs on the same scenarios, means over their world seeds."""

    own: Floats
    """(S, K) of a strategy."""
    fixed: Floats
    """(K,) of the best fixed option."""
    oracle: Floats
    """(K,) of the oracle; those of the best fixed option if there is none."""

    def means(self, scenarios: Ints, seeds: Ints | None = None, axis: int = -1) -> Floats:
        """Return the means (3, ...) of own, fixed and oracle excesses over the scenarios and seeds drawn.

        Args:
            scenarios: (..., K) numbers of the scenarios that count.
            seeds: (..., S) numbers of the training seeds that count; the first one unless given.
            axis: of the numbers, always the last one.

        """
        drawn = np.zeros_like(scenarios[..., :1]) if seeds is None else seeds
        own = self.own[drawn[..., :, None], scenarios[..., None, :]].mean(axis=(-2, -1))
        return np.stack([own, self.fixed[scenarios].mean(axis=axis), self.oracle[scenarios].mean(axis=axis)])

    def resampled(self) -> Floats:
        """Return the means (3, B) of resamples; B is 0 with a single scenario."""
        seeds, scenarios = self.own.shape
        samples = [np.arange(count) for count in (scenarios, seeds) if count > 1]  # one seed is no sample to draw from
        return resampled(samples, self.means, COMPARISON_RESAMPLES, paired=False) if scenarios > 1 else np.zeros((3, 0))


def best_fixed_of(excesses: Mapping[str, Floats], fixed: Sequence[str]) -> str:
    """Return the label of the lowest mean of excess costs (S, K, V) among `fixed`, the first of equals."""
    return min(fixed, key=lambda label: float(excesses[label][0].mean()))


def compare_strategies(excesses: Mapping[str, Floats], fixed: tuple[str, ...]) -> StrategyComparison:
    """Return the comparison of strategies by their excess costs (S, K, V).

    `fixed` names those that are one option each; at least one.
    """
    options = np.stack([excesses[label][0] for label in fixed])  # (O, K, V)
    best = best_fixed_of(excesses, fixed)
    crossed = cross_fitted(options) if options.shape[2] > 1 else None
    fixed_means = excesses[best][0].mean(axis=1)
    oracle = fixed_means if crossed is None else crossed
    means = {label: own.mean(axis=2) for label, own in excesses.items()}
    means |= {} if crossed is None else {ORACLE: crossed[None]}
    drawn = Excesses(fixed_means[None], fixed_means, oracle).resampled()
    value = float((fixed_means - oracle).mean())
    gap = None if crossed is None else Estimate(value, interval(drawn[1] - drawn[2]))
    found = StrategyComparison(best, gap, ())
    standings = (_standing(label, Excesses(own, fixed_means, oracle), found.has_gap) for label, own in means.items())
    return StrategyComparison(best, gap, tuple(standings))


def cross_fitted(options: Floats) -> Floats:
    """Return the excess (K,) of the best option of each scenario, chosen on other world seeds than it is judged on.

    options: (O, K, V), V at least 2.

    >>> luck = np.array([[[1.0, 9.0]], [[9.0, 1.0]]])  # each option is good in one world of the scenario only
    >>> float(cross_fitted(luck)[0]), float(luck.min(axis=0).mean())
    (9.0, 1.0)

    """
    others = options.sum(axis=2, keepdims=True) - options
    chosen = others.argmin(axis=0)
    judged: Floats = np.take_along_axis(options, chosen[None], axis=0)[0].mean(axis=1)
    return judged


def ratio_p(ratios: Floats) -> float | None:
    """Return the two-sided p-value of a ratio of 1 by resampled ratios (B,); None without any."""
    if not len(ratios):
        return None
    tail = min(int((ratios <= 1.0).sum()), int((ratios >= 1.0).sum()))
    return min(1.0, 2.0 * (1 + tail) / (1 + len(ratios)))


def _standing(label: str, excesses: Excesses, has_gap: bool) -> StrategyStanding:
    seeds, scenarios = excesses.own.shape
    own, fixed, oracle = excesses.means(np.arange(scenarios), np.arange(seeds))
    drawn = excesses.resampled()
    ratios = drawn[0] / drawn[1]
    share = None
    if has_gap:
        with np.errstate(divide="ignore", invalid="ignore"):  # a resample may have no gap
            shares = (drawn[1] - drawn[0]) / (drawn[1] - drawn[2])
        share = Estimate(float((fixed - own) / (fixed - oracle)), interval(shares))
    return StrategyStanding(
        label,
        Estimate(float(own), interval(drawn[0])),
        Estimate(float(own / fixed), interval(ratios)),
        ratio_p(ratios),
        share,
    )
