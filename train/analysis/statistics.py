"""Means, spreads and ratios of the figures of an experiment, with their 95 % intervals.

Shapes: K scenarios. `std` is the population's (as in the paper's Table 1). `ci95` of a mean is Student's
interval. Ratios of means have theirs by the same distribution (`train.analysis.intervals`).
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from clean_swarm_env.world.mission import MissionResult
from selforg.arrays import Floats
from train.analysis.intervals import Estimate, Interval
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


Figures = Mapping[str, Mapping[str, Floats]]
"""Metric -> condition -> (K,): those of `metrics_of`."""


def distance_metrics(distances: Sequence[float]) -> list[str]:
    """Return the names of the collision figures at each distance [m], samples first."""
    return [f"{kind}_per_s_at_{distance}m" for kind in ("samples", "events") for distance in distances]


def metrics_of(result: MissionResult, distances: Sequence[float]) -> dict[str, float]:
    """Return the metrics of METRICS, those of `distance_metrics`, the cost, the measures of a task, and `completed`."""
    samples, events = result.collision_samples_per_s, result.collision_events_per_s
    return {
        "completed": float(result.completed),
        **dict(zip(METRICS, (result.duration_s, samples[0], events[0]), strict=True)),
        COST: result.cost_s,
        **dict(zip(distance_metrics(distances), (*samples, *events), strict=True)),
        **result.measures,
    }


def figures_of(
    records: Sequence[RunRecord], conditions: Sequence[str], scenarios: Sequence[str], distances: Sequence[float]
) -> Figures:
    """Arrange one record of every scenario (K) and condition as arrays, in the given order."""
    at = {record.key: metrics_of(record.result, distances) for record in records}
    found = {name: [at[scenario, name] for scenario in scenarios] for name in conditions}
    metrics = found[conditions[0]][0]
    return {
        metric: {name: np.array([own[metric] for own in rows]) for name, rows in found.items()} for metric in metrics
    }


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
