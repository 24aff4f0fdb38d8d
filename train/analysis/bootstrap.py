"""The bootstrap: resampled figures and their percentile intervals (`scipy.stats.bootstrap`).

Equal data give equal intervals, because every call seeds its generator with the same number.
"""

from collections.abc import Callable, Sequence

import numpy as np
import scipy.stats

from selforg.arrays import Floats, Ints

BOOTSTRAP_SEED = 2017
BATCH = 500
"""Resamples drawn at a time; bounds the memory to BATCH numbers for each number of the data."""

Interval = tuple[float, float]


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
