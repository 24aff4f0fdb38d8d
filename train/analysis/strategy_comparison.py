"""Comparison of strategies on one family: costs over scenarios and training seeds, between two yardsticks.

The yardsticks are the single best fixed option (that of the lowest mean cost on these very scenarios) and the oracle:
the best fixed option of each scenario. The share of the gap between them that a strategy closes is
(best fixed - strategy) / (best fixed - oracle) of mean costs; above 1 the strategy is better than every choice of one
option for each scenario. Ratios are of means; intervals are bootstraps of 95 % that draw scenarios, the same for both
sides, and training seeds if there are several.

Shapes: S training seeds, K scenarios, O fixed options, B resamples.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats, Ints
from train.analysis.statistics import Interval, interval, resampled

COMPARISON_RESAMPLES = 5_000
"""Bootstrap resamples of a comparison."""
LEAST_GAP = 1e-6
"""Least gap, as a share of the cost of the best fixed option; smaller gaps count as none."""
MOSTLY = 0.975
"""Share of resamples that must have a gap, so that the share of the gap gets an interval."""
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
    cost: Estimate
    """Mean mission cost [s]."""
    ratio: Estimate
    """Ratio of the mean cost to that of the best fixed option."""
    share: Estimate | None
    """Share of the gap that the strategy closes; None without a gap."""


@dataclass(frozen=True)
class StrategyComparison:
    """All strategies on one family."""

    best_fixed: str
    standings: tuple[StrategyStanding, ...]
    """In the order given, the oracle last."""


@dataclass(frozen=True)
class _Costs:
    """Costs on the same scenarios."""

    own: Floats
    """(S, K) of a strategy."""
    fixed: Floats
    """(K,) of the best fixed option."""
    oracle: Floats
    """(K,) of the best fixed option of each scenario."""

    def means(self, scenarios: Ints, seeds: Ints | None = None, axis: int = -1) -> Floats:
        """Return the means (3, ...) of own, fixed and oracle costs over the scenarios and seeds drawn.

        Args:
            scenarios: (..., K) numbers of the scenarios that count.
            seeds: (..., S) numbers of the training seeds that count; the first one unless given.
            axis: of the numbers, always the last one.

        """
        drawn = np.zeros_like(scenarios[..., :1]) if seeds is None else seeds
        own = self.own[drawn[..., :, None], scenarios[..., None, :]].mean(axis=(-2, -1))
        return np.stack([own, self.fixed[scenarios].mean(axis=axis), self.oracle[scenarios].mean(axis=axis)])


def compare_strategies(costs: Mapping[str, Floats], fixed: tuple[str, ...]) -> StrategyComparison:
    """Return the comparison of strategies by their costs (S, K) with S training seeds on K scenarios.

    `fixed` names those that are one option each; at least one.
    """
    options = np.concatenate([costs[label][:1] for label in fixed])  # (O, K)
    best, oracle = int(options.mean(axis=1).argmin()), options.min(axis=0)
    everything = {**costs, ORACLE: oracle[None]}
    standings = [_standing(label, _Costs(own, options[best], oracle)) for label, own in everything.items()]
    return StrategyComparison(fixed[best], tuple(standings))


def _standing(label: str, costs: _Costs) -> StrategyStanding:
    seeds, scenarios = costs.own.shape
    means = costs.means(np.arange(scenarios), np.arange(seeds))
    samples = [np.arange(count) for count in (scenarios, seeds) if count > 1]  # one seed is no sample to draw from
    drawn = resampled(samples, costs.means, COMPARISON_RESAMPLES, paired=False) if scenarios > 1 else np.zeros((3, 0))
    share, shares = _shares(means[:, None]), _shares(drawn)
    certain = len(shares) > MOSTLY * drawn.shape[1]
    return StrategyStanding(
        label,
        Estimate(float(means[0]), interval(drawn[0])),
        Estimate(float(means[0] / means[1]), interval(drawn[0] / drawn[1])),
        Estimate(float(share[0]), interval(shares) if certain else None) if len(share) else None,
    )


def _shares(means: Floats) -> Floats:
    """Return the shares of the gap that a strategy closes, for those of the B `means` (3, B) that have a gap."""
    own, fixed, oracle = means
    gaps = fixed - oracle
    wide = gaps > LEAST_GAP * fixed
    shares: Floats = (fixed - own)[wide] / gaps[wide]
    return shares
