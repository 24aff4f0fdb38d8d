"""Means, spreads and ratios of the figures of an experiment, with their 95 % intervals.

Shapes: C conditions, K scenarios. `std` is the population's (as in the paper's Table 1). `ci95` of a mean is Student's
interval. Ratios of means have theirs by the same distribution (`train.analysis.intervals`).
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from selforg.arrays import Flags, Floats
from train.analysis.intervals import Interval, MeanError
from train.running.runs import RunRecord

METRICS = ("duration_s", "collision_samples_per_s", "collision_events_per_s")
"""Figures of cleaning that are compared between conditions."""
COST = "cost_s"
"""That of other tasks."""
FURTHER_WORLD: Final = re.compile(r"^(test-\d+)\.\d+$")
"""The name of a scenario in a further world."""


@dataclass(frozen=True)
class Summary:
    """Location and spread of one figure over the scenarios; no interval for a single scenario."""

    mean: float
    median: float
    std: float
    ci95: Interval | None


@dataclass(frozen=True)
class Figures:
    """The figures of an experiment as arrays."""

    conditions: tuple[str, ...]
    scenarios: tuple[str, ...]
    completed: Flags
    """(C, K) whether the mission was completed."""
    values: dict[str, Floats]
    """Metric -> (C, K); the metrics of METRICS, those of `distance_metrics`, the cost, and the measures of a task."""


def distance_metrics(distances: Sequence[float]) -> list[str]:
    """Return the names of the collision figures at each distance [m], samples first."""
    return [f"{kind}_per_s_at_{distance}m" for kind in ("samples", "events") for distance in distances]


def figures_of(
    records: Sequence[RunRecord], conditions: Sequence[str], scenarios: Sequence[str], distances: Sequence[float]
) -> Figures:
    """Arrange one record of every scenario (K) and condition (C) as arrays, in the given order."""
    at = {record.key: record.result for record in records}
    rows = [[at[scenario, condition] for scenario in scenarios] for condition in conditions]
    plain = ("duration_s", "completed", COST, "collision_samples_per_s", "collision_events_per_s")
    values = {name: np.array([[getattr(r, name) for r in row] for row in rows]) for name in plain}
    each_distance = np.concatenate([values[name] for name in METRICS[1:]], axis=-1)
    values |= {name: values[name][..., 0] for name in METRICS[1:]}
    values |= dict(zip(distance_metrics(distances), np.moveaxis(each_distance, -1, 0), strict=True))
    values |= {name: np.array([[r.measures[name] for r in row] for row in rows]) for name in rows[0][0].measures}
    completed = values.pop("completed")
    return Figures(tuple(conditions), tuple(scenarios), completed, values)


def summarise(values: Floats) -> Summary:
    """Return location and spread of `values` (K,)."""
    mean, spread = float(values.mean()), MeanError.of(values[None])
    ci95 = None if spread is None else spread.around(mean)
    return Summary(mean, float(np.median(values)), float(values.std()), ci95)


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
