"""The report of an evaluation on a family: the content of `summary.json` and the figures of the tables.

Shapes: S members of a strategy (one for each seed of its training), K scenarios, V world seeds of each.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, scenario_name
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.mission_end import left_cost
from clean_swarm_env.world.task import measures_of
from selector.documents.trust import BASELINE
from selforg.arrays import Floats
from train.analysis.front import PRICES, Front, priced_excess
from train.analysis.spread import Ratio
from train.analysis.statistics import Summary, summarise
from train.analysis.strategy_comparison import BestFixed, StrategyComparison, compare_strategies
from train.analysis.task_report import MeasuredStrategy, by_strategy, measured_strategies
from train.running.runs import RunRecord

LIMITS = (0.5, 2.0)
"""Shares of the time limit by which items that are left are priced once more."""


@dataclass(frozen=True)
class FamilyRuns:
    """The runs of an evaluation on a family."""

    family: FamilyConfig
    goal: str
    """Goal that the strategies choose options for."""
    seed: int
    scenarios: int
    """K."""
    worlds: int
    """V."""
    conditions: Mapping[str, tuple[str, ...]]
    """Label of a strategy -> (S,) names under which the runs of its members are kept."""
    fixed: tuple[str, ...]
    """Labels of the strategies that are one option each."""
    records: Sequence[RunRecord]
    """All runs in the directory, also those of strategies that are not compared."""

    @cached_property
    def missions(self) -> list[MissionConfig]:
        """The missions (K,) of the scenarios."""
        return [self.family.scenario(self.seed, k, "test").mission for k in range(self.scenarios)]

    def results(self) -> dict[str, list[list[list[MissionResult]]]]:
        """Return the results by label: S lists of K lists of V."""
        at = {record.key: record.result for record in self.records}
        return {
            label: [
                [
                    [at[scenario_name("test", k, world), condition] for world in range(self.worlds)]
                    for k in range(self.scenarios)
                ]
                for condition in conditions
            ]
            for label, conditions in self.conditions.items()
        }


@dataclass(frozen=True)
class FamilyReport:
    """All results of an evaluation on a family."""

    runs: FamilyRuns
    summaries: Mapping[str, Mapping[str, Summary]]
    """Label of a strategy -> figure -> summary over the scenarios."""
    comparison: StrategyComparison | None
    """None without fixed options to compare with."""
    limits: Mapping[str, tuple[Ratio, ...]]
    """Label -> ratio to the best fixed option at each of LIMITS; empty if no item was left."""
    front: Front | None
    """Costs over prices of a collision; None for tasks other than cleaning, whose costs are their measures."""
    measured: Sequence[MeasuredStrategy]
    """Measures of the task under each strategy; empty for cleaning."""

    @cached_property
    def left(self) -> dict[str, Floats]:
        """See `unfinished_of`."""
        return unfinished_of(self.runs)

    def unfinished(self, label: str) -> float | None:
        """Return the share of a strategy's missions that were not completed; None where garbage keeps coming."""
        return float(self.left[label].mean()) if label in self.left else None


def family_report_of(runs: FamilyRuns) -> FamilyReport:
    """Compute everything from the records."""
    figures = _figures(runs)
    summaries = {
        label: {name: summarise(values.mean(axis=(0, 2))) for name, values in own.items()}
        for label, own in figures.items()
    }
    comparison = compare_strategies(excesses_of(runs), runs.fixed) if runs.fixed else None
    limits = {} if comparison is None else limit_ratios(runs, comparison.best_fixed)
    measures = measures_of(runs.family.mission)
    front = None if measures else _front(runs, summaries)
    measured = measured_strategies(measures, _measures(runs, [measure.name for measure in measures]), BASELINE)
    return FamilyReport(runs, summaries, comparison, limits, front, measured)


def _measures(runs: FamilyRuns, names: Sequence[str]) -> dict[str, dict[str, Floats]]:
    """Return label -> measure -> its values (K,), the means of members and worlds."""

    def values(results: list[list[list[MissionResult]]], name: str) -> Floats:
        table: Floats = _table(results, lambda result: result.measures[name]).mean(axis=(0, 2))
        return table

    return {label: {name: values(own, name) for name in names} for label, own in runs.results().items()}


def unfinished(mission: MissionConfig, results: Sequence[MissionResult]) -> float | None:
    """Return the share of missions that were not completed, or missed a target; None where garbage keeps coming."""
    return None if mission.continuous else 1.0 - float(np.mean([result.completed for result in results]))


def unfinished_of(runs: FamilyRuns) -> dict[str, Floats]:
    """Return label -> whether missions (S, K, V) were not completed, 1 or 0; nothing where garbage keeps coming."""
    if runs.missions[0].continuous:
        return {}
    return {label: _table(own, lambda r: float(not r.completed)) for label, own in runs.results().items()}


def excesses_of(runs: FamilyRuns, limits: float = 1.0) -> dict[str, Floats]:
    """Return label -> excess costs (S, K, V) [s], items that are left priced by the time limit times `limits`."""
    return {
        label: np.array(
            [
                [
                    [result.excess_s + (limits - 1.0) * left_cost(mission, result.garbage_done) for result in worlds]
                    for mission, worlds in zip(runs.missions, row, strict=True)
                ]
                for row in own
            ]
        )
        for label, own in runs.results().items()
    }


def limit_ratios(runs: FamilyRuns, best: BestFixed) -> dict[str, tuple[Ratio, ...]]:
    """Return label -> ratio to the best fixed option at each of LIMITS; empty if no item was left."""
    priced = [excesses_of(runs, limits) for limits in LIMITS]
    if all(np.array_equal(priced[0][label], own) for label, own in priced[1].items()):
        return {}
    yardsticks = [best.judged(own).mean(axis=(0, 2)) for own in priced]
    return {
        label: tuple(Ratio.of(own[label].mean(axis=2), other) for own, other in zip(priced, yardsticks, strict=True))
        for label in runs.conditions
    }


def family_summary_json(report: FamilyReport) -> str:
    """Return the content of `summary.json`."""
    runs, comparison = report.runs, report.comparison
    content: dict[str, Any] = {
        "family": runs.family.name,
        "goal": runs.goal,
        "scenarios": runs.scenarios,
        "worlds": runs.worlds,
        "seed": runs.seed,
        "strategies": {
            label: {name: asdict(summary) for name, summary in own.items()} for label, own in report.summaries.items()
        },
    }
    if report.front is not None:
        front = {"prices_s": PRICES, "excess_s": report.front.excesses, "undominated": report.front.undominated}
        content["front"] = front
    content |= by_strategy(report.measured)
    if comparison is not None:
        content["best_fixed"] = comparison.best_fixed.labels
        content["limits"] = {label: [one.content for one in own] for label, own in report.limits.items()}
        content["gap"] = None if comparison.gap is None else asdict(comparison.gap)
        content["comparison"] = [standing.content for standing in comparison.standings]
    return json.dumps(content, indent=2) + "\n"


def _figures(runs: FamilyRuns) -> dict[str, dict[str, Floats]]:
    """Return label -> figure -> (S, K, V)."""
    rate = runs.family.mission.world.control_rate
    kinds: dict[str, Callable[[MissionResult], float]] = {
        "cost_s": lambda r: r.cost_s,
        "excess_s": lambda r: r.excess_s,
        "duration_s": lambda r: r.duration_s,
        "events": lambda r: r.collision_events_per_s[0] * r.ticks / rate,
        "events_per_s": lambda r: r.collision_events_per_s[0],
        "contact_s": lambda r: r.collision_samples_per_s[0] * r.ticks / rate / runs.family.mission.world.physics_rate,
        "items": lambda r: float(r.garbage_done),
        "completed": lambda r: float(r.completed),
    }
    return {label: {name: _table(own, kind) for name, kind in kinds.items()} for label, own in runs.results().items()}


def _table(results: list[list[list[MissionResult]]], figure: Callable[[MissionResult], float]) -> Floats:
    """Return a figure (S, K, V) of the results."""
    return np.array([[[figure(result) for result in worlds] for worlds in row] for row in results])


def _front(runs: FamilyRuns, summaries: Mapping[str, Mapping[str, Summary]]) -> Front:
    excesses = {
        label: tuple(
            float(
                np.mean(
                    [
                        priced_excess(mission, result, price)
                        for row in own
                        for mission, worlds in zip(runs.missions, row, strict=True)
                        for result in worlds
                    ]
                )
            )
            for price in PRICES
        )
        for label, own in runs.results().items()
    }
    return Front(excesses, {label: own["events"].mean for label, own in summaries.items()})
