"""The report of an evaluation on a family: the content of `summary.json` and the figures of the tables.

Shapes: S members of a strategy (one for each seed of its training), K scenarios.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from selforg.arrays import Floats
from train.analysis.statistics import Summary, summarise
from train.analysis.strategy_comparison import StrategyComparison, compare_strategies
from train.running.runs import RunRecord


@dataclass(frozen=True)
class FamilyRuns:
    """The runs of an evaluation on a family."""

    family: FamilyConfig
    goal: str
    """Goal that the strategies choose options for."""
    seed: int
    scenarios: tuple[str, ...]
    """(K,) names."""
    conditions: Mapping[str, tuple[str, ...]]
    """Label of a strategy -> (S,) names under which the runs of its members are kept."""
    fixed: tuple[str, ...]
    """Labels of the strategies that are one option each."""
    records: Sequence[RunRecord]
    """All runs in the directory, also those of strategies that are not compared."""


@dataclass(frozen=True)
class FamilyReport:
    """All results of an evaluation on a family."""

    runs: FamilyRuns
    summaries: Mapping[str, Mapping[str, Summary]]
    """Label of a strategy -> figure -> summary over the scenarios."""
    comparison: StrategyComparison | None
    """None without fixed options to compare with."""


def family_report_of(runs: FamilyRuns) -> FamilyReport:
    """Compute everything from the records."""
    figures = _figures(runs)
    summaries = {
        label: {name: summarise(values.mean(axis=0)) for name, values in own.items()} for label, own in figures.items()
    }
    costs = {label: own["cost_s"] for label, own in figures.items()}
    return FamilyReport(runs, summaries, compare_strategies(costs, runs.fixed) if runs.fixed else None)


def family_summary_json(report: FamilyReport) -> str:
    """Return the content of `summary.json`."""
    runs, comparison = report.runs, report.comparison
    content: dict[str, Any] = {
        "family": runs.family.name,
        "goal": runs.goal,
        "scenarios": len(runs.scenarios),
        "seed": runs.seed,
        "strategies": {
            label: {name: asdict(summary) for name, summary in own.items()} for label, own in report.summaries.items()
        },
    }
    if comparison is not None:
        content["best_fixed"] = comparison.best_fixed
        content["comparison"] = [asdict(standing) for standing in comparison.standings]
    return json.dumps(content, indent=2) + "\n"


def _figures(runs: FamilyRuns) -> dict[str, dict[str, Floats]]:
    """Return label -> figure -> (S, K)."""
    period = 1.0 / runs.family.mission.world.control_rate
    at = {record.key: record.result for record in runs.records}
    figures = {}
    for label, conditions in runs.conditions.items():
        table = [[at[scenario, condition] for scenario in runs.scenarios] for condition in conditions]
        figures[label] = {
            "cost_s": np.array([[r.cost_s for r in row] for row in table]),
            "duration_s": np.array([[r.duration_s for r in row] for row in table]),
            "events": np.array([[r.collision_events_per_s[0] * r.ticks * period for r in row] for row in table]),
            "events_per_s": np.array([[r.collision_events_per_s[0] for r in row] for row in table]),
            "items": np.array([[float(r.garbage_done) for r in row] for row in table]),
            "completed": np.array([[float(r.completed) for r in row] for row in table]),
        }
    return figures
