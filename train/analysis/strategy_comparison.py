"""How strategies compare on one family: costs over scenarios and training seeds, and what lies between two yardsticks.

The yardsticks are the single best fixed option (that of the lowest mean cost on these very scenarios) and the oracle:
the best fixed option of each scenario. The share of the gap between them that a strategy closes is
(best fixed - strategy) / (best fixed - oracle) of mean costs; above 1 it is better than any choice of one option for
each scenario. Ratios are of means; intervals are bootstraps of 95 % that draw scenarios, the same for both sides, and
training seeds where there are several.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from train.analysis.statistics import BOOTSTRAP_SEED, Interval

Floats = NDArray[np.float64]
RESAMPLES = 5_000
"""Bootstrap resamples."""
LEAST_GAP = 1e-6
"""Share of the best fixed option's cost below which a gap is none."""
MOSTLY = 0.975
"""Share of resamples that need a gap for its share to have an interval."""
ORACLE = "oracle"


@dataclass(frozen=True)
class Estimate:
    """A figure and its interval."""

    value: float
    ci95: Interval | None


@dataclass(frozen=True)
class Standing:
    """Where one strategy stands."""

    label: str
    cost: Estimate
    """Mean mission cost [s]."""
    ratio: Estimate
    """Its ratio to the best fixed option's."""
    share: Estimate | None
    """Share of the gap that it closes; None where there is no gap."""


@dataclass(frozen=True)
class Comparison:
    """All strategies on one family."""

    best_fixed: str
    standings: tuple[Standing, ...]
    """In the order given, the oracle last."""


def compare(costs: Mapping[str, Floats], fixed: tuple[str, ...]) -> Comparison:
    """Return the comparison of strategies by their costs (S, K) with S training seeds on K scenarios.

    `fixed` names those that are one option each; at least one.
    """
    options = np.concatenate([costs[label][:1] for label in fixed])  # (O, K)
    best = int(options.mean(axis=1).argmin())
    drawn = _drawn(options.shape[1])
    resampled = options[:, drawn].mean(axis=2) if drawn is not None else None  # (O, B)
    everything = {**costs, ORACLE: options.min(axis=0, keepdims=True)}
    standings = []
    for label, own in everything.items():
        standings.append(_standing(label, own, options, best, drawn, resampled))
    return Comparison(fixed[best], tuple(standings))


def _drawn(scenarios: int) -> NDArray[np.int64] | None:
    """Return numbers of scenarios (B, K) drawn with replacement; None for a single one."""
    if scenarios < 2:
        return None
    return np.random.default_rng(BOOTSTRAP_SEED).integers(scenarios, size=(RESAMPLES, scenarios))


def _standing(
    label: str, own: Floats, options: Floats, best: int, drawn: NDArray[np.int64] | None, resampled: Floats | None
) -> Standing:
    """Return where the costs `own` (S, K) stand among those of the `options` (O, K)."""
    oracle = options.min(axis=0)
    mean, fixed_mean, gap = own.mean(), options[best].mean(), options[best].mean() - oracle.mean()
    share = float((fixed_mean - mean) / gap) if gap > LEAST_GAP * fixed_mean else None
    if drawn is None or resampled is None:
        plain = Estimate(float(mean / fixed_mean), None)
        return Standing(label, Estimate(float(mean), None), plain, None if share is None else Estimate(share, None))
    seeds = np.random.default_rng(BOOTSTRAP_SEED + 1).integers(len(own), size=(RESAMPLES, len(own)))
    means = own[seeds].mean(axis=1) if len(own) > 1 else None  # (B, K)
    own_means = own[0][drawn].mean(axis=1) if means is None else np.take_along_axis(means, drawn, 1).mean(axis=1)
    fixed_means, gaps = resampled[best], resampled[best] - oracle[drawn].mean(axis=1)
    wide = gaps > LEAST_GAP * fixed_means
    shares = (fixed_means - own_means)[wide] / gaps[wide]
    return Standing(
        label,
        Estimate(float(mean), _interval(own_means)),
        Estimate(float(mean / fixed_mean), _interval(own_means / fixed_means)),
        None if share is None else Estimate(share, _interval(shares) if wide.mean() > MOSTLY else None),
    )


def _interval(values: Floats) -> Interval | None:
    if not len(values):
        return None
    low, high = np.quantile(values, [0.025, 0.975])
    return float(low), float(high)
