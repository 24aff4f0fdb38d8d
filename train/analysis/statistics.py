"""Means and spreads of figures, with their 95 % intervals.

Shapes: K scenarios. `std` is the population's (as in the paper's Table 1). `ci95` of a mean is Student's
interval. Ratios of means have theirs by the same distribution (`train.analysis.intervals`).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from selforg.arrays import Floats
from train.analysis.intervals import Estimate, Interval

FURTHER_WORLD: Final = re.compile(r"^(test-\d+)\.\d+$")
"""The name of a scenario in a further world."""


@dataclass(frozen=True)
class Summary:
    """Location and spread of one figure over the scenarios; no interval for a single scenario."""

    mean: float
    median: float
    std: float
    ci95: Interval | None


def summarise(values: Floats) -> Summary:
    """Return location and spread of `values` (K,)."""
    mean = Estimate.of(values[None])
    return Summary(mean.value, float(np.median(values)), float(values.std()), mean.ci95)


def by_scenario(values: Floats, scenarios: Sequence[str]) -> Floats:
    """Return the means of known `values` (K,) over the worlds of each scenario."""
    found: dict[str, list[float]] = {}
    for name, value in zip(scenarios, values.tolist(), strict=True):
        if np.isfinite(value):
            found.setdefault(FURTHER_WORLD.sub(r"\1", name), []).append(value)
    return np.array([np.mean(own) for own in found.values()])


def share_cell(share: float | None) -> str:
    """Return a share in per cent, which is never rounded to nothing; empty if there is none."""
    return "" if share is None else "<1%" if 0.0 < share < 0.005 else f"{share:.0%}"
