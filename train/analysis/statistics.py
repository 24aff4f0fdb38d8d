"""Means, spreads and ratios of the figures of an experiment, with their 95 % intervals.

Shapes: C conditions, K scenarios. `std` is the population's (as in the paper's Table 1). `ci95` of a mean is Student's
interval, whose level is more exact than that of a bootstrap for the five scenarios of the paper. A ratio is a ratio of
means; its interval is a percentile bootstrap that draws scenarios, the same ones for both means
(`scipy.stats.bootstrap`). Equal data give equal intervals, because every bootstrap seeds its generator with one number.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.stats

from selforg.arrays import Flags, Floats, Ints
from train.running.runs import RunRecord

METRICS = ("duration_s", "collision_samples_per_s", "collision_events_per_s")
RESAMPLES = 10_000
"""Bootstrap resamples of a ratio."""
BOOTSTRAP_SEED = 2017
BATCH = 500
"""Resamples drawn at a time; bounds the memory to BATCH numbers for each number of the data."""

Interval = tuple[float, float]


@dataclass(frozen=True)
class Summary:
    """Location and spread of one figure over the scenarios; no interval for a single scenario."""

    mean: float
    median: float
    std: float
    ci95: Interval | None


@dataclass(frozen=True)
class Ratio:
    """Ratio of two means (None if the denominator is zero) and its interval (None if it is not finite)."""

    ratio: float | None
    ci95: Interval | None


@dataclass(frozen=True)
class Figures:
    """The figures of an experiment as arrays."""

    conditions: tuple[str, ...]
    scenarios: tuple[str, ...]
    completed: Flags
    """(C, K) whether the mission was completed."""
    values: dict[str, Floats]
    """Metric -> (C, K); the metrics of METRICS, and those of `distance_metrics`."""


def distance_metrics(distances: Sequence[float]) -> list[str]:
    """Return the names of the collision figures at each distance [m], samples first."""
    return [f"{kind}_per_s_at_{distance}m" for kind in ("samples", "events") for distance in distances]


def figures_of(
    records: Sequence[RunRecord], conditions: Sequence[str], scenarios: Sequence[str], distances: Sequence[float]
) -> Figures:
    """Arrange one record of every scenario (K) and condition (C) as arrays, in the given order."""
    at = {record.key: record.result for record in records}
    rows = [[at[scenario, condition] for scenario in scenarios] for condition in conditions]
    values = {"duration_s": np.array([[r.duration_s for r in row] for row in rows])}
    samples = np.array([[r.collision_samples_per_s for r in row] for row in rows])
    events = np.array([[r.collision_events_per_s for r in row] for row in rows])
    values |= {"collision_samples_per_s": samples[..., 0], "collision_events_per_s": events[..., 0]}
    each_distance = np.moveaxis(np.concatenate([samples, events], axis=-1), -1, 0)
    values |= dict(zip(distance_metrics(distances), each_distance, strict=True))
    completed = np.array([[r.completed for r in row] for row in rows])
    return Figures(tuple(conditions), tuple(scenarios), completed, values)


def summarise(values: Floats) -> Summary:
    """Return location and spread of `values` (K,)."""
    mean, count = float(values.mean()), len(values)
    ci95 = None
    if count > 1:
        half = float(scipy.stats.t.ppf(0.975, count - 1) * values.std(ddof=1) / np.sqrt(count))
        ci95 = (mean - half, mean + half)
    return Summary(mean, float(np.median(values)), float(values.std()), ci95)


def half_width(count: float, variance: float) -> float | None:
    """Return half the width of the 95 % interval of a mean by Student; None for less than two numbers.

    Args:
        count: of the numbers.
        variance: their mean squared deviation from their mean.

    """
    return float(scipy.stats.t.ppf(0.975, count - 1) * np.sqrt(variance / (count - 1))) if count > 1 else None


def ratio_of_means(a: Floats, b: Floats) -> Ratio:
    """Return mean(a) / mean(b) for paired `a` and `b` (K,) with its bootstrap interval over the pairs."""
    if b.mean() == 0.0:
        return Ratio(None, None)
    ratio = float(a.mean() / b.mean())
    if len(a) == 1:
        return Ratio(ratio, None)
    above, below = resampled((a, b), _sums, RESAMPLES, paired=True)
    ratios = np.divide(above, below, out=np.full(RESAMPLES, np.inf), where=below != 0.0)
    return Ratio(ratio, interval(ratios))


def _sums(a: Floats, b: Floats, axis: int = -1) -> Floats:
    """Return the sums (2, ...) of both along an axis."""
    return np.stack([a.sum(axis=axis), b.sum(axis=axis)])


def resampled(
    samples: Sequence[Floats | Ints], statistic: Callable[..., Floats], resamples: int, *, paired: bool
) -> Floats:
    """Return `statistic` for B samples drawn with replacement, (B,), or (V, B) if the statistic has V values.

    Args:
        samples: arrays of at least two numbers each.
        statistic: vectorised function of the samples and of the axis of their numbers.
        resamples: B.
        paired: whether one draw of indices serves all samples.

    """
    found = scipy.stats.bootstrap(
        samples,
        statistic,
        n_resamples=resamples,
        batch=BATCH,
        vectorized=True,
        paired=paired,
        method="percentile",
        rng=np.random.default_rng(BOOTSTRAP_SEED),
    )
    distribution: Floats = found.bootstrap_distribution
    return distribution


def interval(values: Floats) -> Interval | None:
    """Return the 95 % percentile interval of resampled `values` (B,); None without values, or if it is not finite."""
    if not len(values):
        return None
    with np.errstate(invalid="ignore"):  # between two infinite values
        low, high = np.quantile(values, [0.025, 0.975]).tolist()
    return (low, high) if np.isfinite([low, high]).all() else None
