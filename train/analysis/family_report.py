"""The report of an evaluation on a family: the content of `summary.json` and the figures of the tables.

Shapes: S members of a strategy (one for each seed of its training), K scenarios, V world seeds of each.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property, partial
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, scenario_name
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import items_keep_coming
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.task import Task, task_class
from selector.documents.trust import BASELINE
from selforg.arrays import Floats
from train.analysis.intervals import Ratio
from train.analysis.statistics import Summary, summarise
from train.analysis.strategy_comparison import StrategyComparison, compare_strategies
from train.analysis.task_report import MeasuredStrategy, by_strategy, measured_strategies
from train.analysis.verdict import RANDOM, Ranking, unfinished_sentence
from train.running.runs import RunRecord, under

NEVER_AVOIDS = "fixed:Off"
"""Label of the strategy that never avoids."""
Figure = Callable[[MissionConfig, MissionResult], float]
FIGURES: Final[Mapping[str, Figure]] = {
    "cost_s": lambda _, r: r.cost_s,
    "excess_s": lambda _, r: r.excess_s,
    "duration_s": lambda _, r: r.duration_s,
    "events": lambda m, r: r.collision_events_per_s[0] * r.ticks / m.world.control_rate,
    "events_per_s": lambda _, r: r.collision_events_per_s[0],
    "contact_s": lambda m, r: r.collision_samples_per_s[0] * r.ticks / m.world.control_rate / m.world.physics_rate,
    "items": lambda _, r: float(r.garbage_done),
    "completed": lambda _, r: float(r.completed),
}


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

    def within(self, variant: str) -> FamilyRuns:
        """Return the runs in a variant of the family."""
        named = {label: tuple(under(variant, own) for own in names) for label, names in self.conditions.items()}
        return replace(self, conditions=named)

    def table(self, figure: Figure) -> dict[str, Floats]:
        """Return label -> a figure (S, K, V) of all results."""
        at = {record.key: record.result for record in self.records}
        return {
            label: np.array(
                [
                    [
                        [figure(mission, at[scenario_name("test", k, world), name]) for world in range(self.worlds)]
                        for k, mission in enumerate(self.missions)
                    ]
                    for name in names
                ]
            )
            for label, names in self.conditions.items()
        }


@dataclass(frozen=True)
class FamilyReport:
    """All results of an evaluation on a family."""

    runs: FamilyRuns
    summaries: Mapping[str, Mapping[str, Summary]]
    """Label of a strategy -> figure -> summary over the scenarios."""
    comparison: StrategyComparison | None
    """None without fixed options to compare with."""
    measured: Sequence[MeasuredStrategy]
    """Measures of the task under each strategy; empty for a task that has prices instead."""

    @property
    def task(self) -> type[Task[Any, Any]]:
        """The class of the task."""
        return task_class(self.runs.family.mission)

    @cached_property
    def left(self) -> dict[str, Floats]:
        """See `unfinished_of`."""
        return unfinished_of(self.runs)

    @cached_property
    def ranking(self) -> Ranking:
        """The strategies by their excess."""
        return ranking_of(self.runs)

    @property
    def compared(self) -> str:
        """What is compared: the excess, or the cost where they are the same."""
        own = self.summaries.values()
        return "cost" if all(figures["excess_s"] == figures["cost_s"] for figures in own) else "excess"

    @property
    def verdict(self) -> list[str]:
        """What came out, in one to three sentences."""
        random = RANDOM in self.runs.conditions
        tried = [label for label in self.runs.conditions if random and label not in (*self.runs.fixed, RANDOM)]
        found = self.ranking.sentences((NEVER_AVOIDS, BASELINE, RANDOM), tried)
        return [*found, *filter(None, [unfinished_sentence(self.left, self.ranking, self.task.missed[1])])]

    @property
    def content(self) -> dict[str, Any]:
        """Content of `summary.json`."""
        runs, comparison = self.runs, self.comparison
        content: dict[str, Any] = {
            "family": runs.family.name,
            "goal": runs.goal,
            "scenarios": runs.scenarios,
            "worlds": runs.worlds,
            "seed": runs.seed,
            "strategies": {
                label: {name: asdict(summary) for name, summary in own.items()} for label, own in self.summaries.items()
            },
        }
        content |= by_strategy(self.measured)
        if comparison is not None:
            content["best_fixed"] = comparison.best_fixed.labels
            content["gap"] = None if comparison.gap is None else asdict(comparison.gap)
            content["comparison"] = [
                {**asdict(standing), "ratio": standing.ratio.content} for standing in comparison.standings
            ]
        return content


def family_report_of(runs: FamilyRuns) -> FamilyReport:
    """Compute everything from the records; the strategies are in the order of their excess."""
    runs = replace(runs, conditions={label: runs.conditions[label] for label in ranking_of(runs).labels})
    figures = {name: runs.table(figure) for name, figure in FIGURES.items()}
    summaries = {
        label: {name: summarise(values[label].mean(axis=(0, 2))) for name, values in figures.items()}
        for label in runs.conditions
    }
    comparison = compare_strategies(excesses_of(runs), runs.fixed, censored(runs)) if runs.fixed else None
    measures = task_class(runs.family.mission).measures
    tables = {one.name: runs.table(partial(lambda name, _, r: r.measures[name], one.name)) for one in measures}
    return FamilyReport(runs, summaries, comparison, measured_strategies(measures, tables, BASELINE))


def ranking_of(runs: FamilyRuns) -> Ranking:
    """Return the strategies by their excess; the worlds of a scenario count as one."""
    off = "never avoiding" if AVOIDANCE in runs.goal else "Off"
    return Ranking.of(excesses_of(runs), left=censored(runs), spoken={NEVER_AVOIDS: off})


def unfinished_of(runs: FamilyRuns) -> dict[str, Floats]:
    """Return label -> whether missions (S, K, V) were not completed, 1 or 0; nothing where garbage keeps coming."""
    if items_keep_coming(runs.missions[0]):
        return {}
    return runs.table(lambda _, result: float(not result.completed))


def censored(runs: FamilyRuns) -> dict[str, Floats]:
    """Return `unfinished_of` where a task has no measures: by these, costs are known however a mission ends."""
    return {} if task_class(runs.family.mission).measures else unfinished_of(runs)


def ratio_of(runs: FamilyRuns, label: str, to: str) -> Ratio:
    """Return the ratio of the mean excess of a strategy to that of another."""
    return Ratio.between(label, to, excesses_of(runs), censored(runs))


def excesses_of(runs: FamilyRuns) -> dict[str, Floats]:
    """Return label -> excess costs (S, K, V) [s]."""
    return runs.table(FIGURES["excess_s"])
