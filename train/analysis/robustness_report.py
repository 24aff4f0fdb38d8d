"""The report of strategies under disturbances: completion, duration and collisions, each with its interval."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np
import scipy.stats

from clean_swarm_env.config.families import RobustnessConfig
from clean_swarm_env.world.mission import MissionResult
from train.analysis.intervals import TAIL, Interval
from train.analysis.strategy_comparison import Estimate
from train.running.runs import RunKey, under

ROBUSTNESS_FIGURES = ("completed", "duration_s", "collision_events")
"""Share of missions completed, duration or time limit [s], and collision events of a mission at the first distance."""


@dataclass(frozen=True)
class RobustnessRuns:
    """The runs of an evaluation under disturbances."""

    robustness: RobustnessConfig
    seed: int
    scenarios: tuple[str, ...]
    """(K,) names."""
    conditions: Mapping[str, tuple[str, ...]]
    """Label of a strategy -> (S,) names of its members."""


@dataclass(frozen=True)
class RobustnessReport:
    """All results of an evaluation under disturbances."""

    runs: RobustnessRuns
    estimates: Mapping[str, Mapping[str, Mapping[str, Estimate]]]
    """Disturbance -> label of a strategy -> figure of ROBUSTNESS_FIGURES -> its mean and interval."""

    @classmethod
    def of(cls, runs: RobustnessRuns, results: Mapping[RunKey, MissionResult]) -> RobustnessReport:
        """Compute everything from the results."""
        period = 1.0 / runs.robustness.mission.world.control_rate
        estimates = {
            name: {
                label: _estimates(
                    [[results[scenario, under(name, own)] for scenario in runs.scenarios] for own in members], period
                )
                for label, members in runs.conditions.items()
            }
            for name in runs.robustness.disturbed
        }
        return cls(runs, estimates)


def _estimates(results: list[list[MissionResult]], period: float) -> dict[str, Estimate]:
    """Return the figures of results (S, K) of S members on K scenarios; means over members count once a scenario."""
    durations = np.array([[r.duration_s for r in row] for row in results])
    events = np.array([[r.collision_events_per_s[0] * r.ticks * period for r in row] for row in results])
    completed = np.array([[r.completed for r in row] for row in results])
    share = float(completed.mean())
    return {
        "completed": Estimate(share, wilson(share, completed.shape[1])),
        "duration_s": Estimate.of(durations),
        "collision_events": Estimate.of(events),
    }


def wilson(share: float, scenarios: int) -> Interval:
    """Return Wilson's 95 % interval of a share over scenarios, each of which may be a mean over members."""
    squared = float(scipy.stats.norm.isf(TAIL)) ** 2
    middle = share + squared / (2.0 * scenarios)
    half = np.sqrt(squared * (share * (1.0 - share) / scenarios + squared / (4.0 * scenarios**2)))
    below, above = ((middle + side * half) / (1.0 + squared / scenarios) for side in (-1.0, 1.0))
    return max(float(below), 0.0), min(float(above), 1.0)


def robustness_summary_json(report: RobustnessReport) -> str:
    """Return the content of `summary.json`."""
    runs = report.runs
    content = {
        "experiment": runs.robustness.name,
        "seed": runs.seed,
        "scenarios": len(runs.scenarios),
        "disturbances": {
            name: {
                label: {figure: asdict(estimate) for figure, estimate in own.items()} for label, own in by_label.items()
            }
            for name, by_label in report.estimates.items()
        },
    }
    return json.dumps(content, indent=2) + "\n"
