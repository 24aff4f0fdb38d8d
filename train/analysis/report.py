"""The report of an experiment: the content of `summary.json`, and the figures of the tables and the picture.

It compares our figures with those that another implementation measured on the same start configurations. Only the
scenarios that have the figure on both sides count. Means agree when 1 lies in the interval of their ratio (scenarios
drawn in pairs); ratios between two conditions agree when their two intervals meet.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.tasks import items_keep_coming
from clean_swarm_env.world.task import Task, task_class
from selector.documents.trust import BASELINE
from selforg.arrays import Floats
from train.analysis.intervals import Interval, Ratio
from train.analysis.statistics import COST, METRICS, Figures, Summary, distance_metrics, figures_of, summarise
from train.analysis.task_report import MeasuredStrategy, by_strategy, measured_strategies
from train.analysis.verdict import MOST_NAMED, Ranking, amount, unfinished_sentence
from train.running.runs import RunRecord

Measured = Mapping[str, Mapping[str, Mapping[str, float | None]]]
"""Scenario -> name of a condition -> figure -> value."""


@dataclass(frozen=True)
class Agreement:
    """One of our figures beside that of the paper, or the measured one; a mean or the ratio of two conditions."""

    what: str
    ours: float
    theirs: float
    """NaN for a ratio that there is not."""
    agrees: bool | None
    """Whether the intervals meet, or 1 is in that of the ratio on the same starts; None without intervals."""
    content: Mapping[str, Any] = field(default_factory=dict)
    """For `summary.json`, of those that were measured."""


@dataclass(frozen=True)
class Report:
    """All results of an evaluation."""

    experiment: ExperimentConfig
    seed: int
    figures: Figures
    published: Measured
    """Figures that were measured on the same starts, by the conditions' names there."""
    own_starts: bool
    """Whether the scenarios are those of the experiment, for each of which figures may have been published."""

    @property
    def task(self) -> type[Task[Any, Any]]:
        """The class of the task."""
        return task_class(self.experiment.mission)

    @property
    def conditions(self) -> list[str]:
        """The names of the conditions."""
        return [condition.name for condition in self.experiment.conditions]

    @property
    def scenarios(self) -> list[str]:
        """The names (K,) of the scenarios."""
        return [start.id for start in self.experiment.starts]

    @cached_property
    def left(self) -> dict[str, Floats]:
        """Condition -> 1 where a mission was not completed (1, K, 1), else 0; nothing where garbage keeps coming."""
        if items_keep_coming(self.experiment.mission):
            return {}
        return {name: 1.0 - done[None, :, None] for name, done in self.figures["completed"].items()}

    @cached_property
    def summaries(self) -> dict[str, dict[str, Summary]]:
        """Condition -> metric -> summary."""
        measures = [measure.name for measure in self.task.measures]
        metrics = (*METRICS, *((COST, *measures) if measures else ()))
        return {name: {each: summarise(self.figures[each][name]) for each in metrics} for name in self.conditions}

    @cached_property
    def comparisons(self) -> dict[tuple[str, str, str], Ratio]:
        """Conditions a and b, metric -> ratio of the means."""
        return {
            (a, b, metric): Ratio.between(a, b, self.figures[metric], self.left if metric == METRICS[0] else None)
            for a, b in itertools.combinations(self.conditions, 2)
            for metric in ((COST,) if self.task.measures else METRICS)
        }

    @cached_property
    def measured(self) -> list[MeasuredStrategy]:
        """Measures of the task under each condition; empty for a task that has prices instead."""
        baseline = next((each.name for each in self.experiment.conditions if each.strategy == BASELINE), "")
        return measured_strategies(self.task.measures, self.figures, baseline)

    @cached_property
    def ranking(self) -> Ranking:
        """The conditions by their duration, or by the cost of a task."""
        metric, verb = (COST, "costs") if self.task.measures else (METRICS[0], "takes")
        return Ranking.of(self.figures[metric], verb, left={} if self.task.measures else self.left)

    @cached_property
    def means(self) -> list[Agreement]:
        """Means beside those that were measured; empty without them."""
        both = itertools.product(self.conditions, self._metrics)
        return [self._mean(*each) for each in both if self.beside(*each)]

    @cached_property
    def ratios(self) -> list[Agreement]:
        """Ratios of two conditions beside those of measured figures of both; empty without them."""
        return [
            self._ratio(a, b, metric)
            for a, b in itertools.combinations(self.conditions, 2)
            for metric in self._metrics
            if self.beside(a, metric).keys() & self.beside(b, metric).keys()
        ]

    @property
    def _metrics(self) -> list[str]:
        return [METRICS[0], *distance_metrics(self.experiment.mission.collision_distances)]

    def ours(self, condition: str, metric: str) -> dict[str, float]:
        """Return scenario -> our figure."""
        return dict(zip(self.scenarios, self.figures[metric][condition].tolist(), strict=True))

    def beside(self, condition: str, metric: str) -> dict[str, float]:
        """Return scenario -> the measured figure, where there is one."""
        (key,) = (each.measured or "" for each in self.experiment.conditions if each.name == condition)
        found = {scenario: self.published.get(scenario, {}).get(key, {}).get(metric) for scenario in self.scenarios}
        return {scenario: value for scenario, value in found.items() if value is not None}

    def _mean(self, condition: str, metric: str) -> Agreement:
        theirs = self.beside(condition, metric)
        ours = [self.ours(condition, metric)[scenario] for scenario in theirs]
        both = np.array([ours, list(theirs.values())])
        found, (mine, other) = Ratio.of(*both), (float(each.mean()) for each in both)
        agrees = None if found.ci95 is None else found.ci95[0] <= 1.0 <= found.ci95[1]
        content = {"condition": condition, "metric": metric, "n": len(ours), "ours": mine, "measured": other}
        content |= {"ratio": found.ratio, "ci95": found.ci95, "agrees": agrees}
        return Agreement(_words(metric, condition), mine, other, agrees, content)

    def _ratio(self, a: str, b: str, metric: str) -> Agreement:
        first, second = self.beside(a, metric), self.beside(b, metric)
        both = [scenario for scenario in first if scenario in second]
        figures = (self.ours(a, metric), self.ours(b, metric), first, second)
        values = [np.array([each[scenario] for scenario in both]) for each in figures]
        ours, theirs = Ratio.of(values[0], values[1]), Ratio.of(values[2], values[3])
        agrees = _meet(ours.ci95, theirs.ci95)
        content = {"a": a, "b": b, "metric": metric, "n": len(both), "ours": ours.content, "measured": theirs.content}
        mine, other = (math.nan if one.ratio is None else one.ratio for one in (ours, theirs))
        return Agreement(_words(metric, f"{a} / {b}"), mine, other, agrees, {**content, "agrees": agrees})


def report_of(
    experiment: ExperimentConfig, seed: int, records: Sequence[RunRecord], measured: Measured, *, own_starts: bool
) -> Report:
    """Return the report on the records of all runs; `measured` figures may be missing."""
    conditions, starts = [each.name for each in experiment.conditions], [start.id for start in experiment.starts]
    figures = figures_of(records, conditions, starts, experiment.mission.collision_distances)
    return Report(experiment, seed, figures, measured, own_starts)


def agreements(report: Report) -> list[Agreement]:
    """Return what there is beside our figures: measured on the same starts, else published with the experiment."""
    found = [*report.means, *(one for one in report.ratios if math.isfinite(one.ours + one.theirs))]
    if found or report.experiment.reference is None:
        return found
    published = report.experiment.reference.figures
    for name, figures in published.items():
        for metric, values in figures.items() if name in report.summaries else ():
            own, theirs = report.summaries[name][metric], summarise(np.array(values))
            found.append(Agreement(_words(metric, name), own.mean, theirs.mean, _meet(own.ci95, theirs.ci95)))
    for (a, b, metric), ours in report.comparisons.items():
        first, second = (np.array(published.get(name, {}).get(metric, ())) for name in (a, b))
        paper = Ratio.of(first, second) if first.size == second.size > 0 else None
        if paper is not None and paper.ratio is not None and ours.ratio is not None:
            what = _words(metric, f"{a} / {b}")
            found.append(Agreement(what, ours.ratio, paper.ratio, _meet(ours.ci95, paper.ci95)))
    return found


def verdict_of(report: Report) -> list[str]:
    """Return what came out, in one to three sentences."""
    source = "measured" if report.means else "the paper"
    those = source if report.means else f"of {source} (95 % intervals meet)"
    known = [one for one in agreements(report) if one.agrees is not None]
    others = [f"{one.what} ({amount(one.ours)}, {source} {amount(one.theirs)})" for one in known if not one.agrees]
    said = f"{len(known) - len(others)} of {len(known)} figures agree with those {those}"
    compared = [f"{said}{'; not: ' * bool(others)}{'; '.join(others[:MOST_NAMED])}."] if known else []
    unfinished = unfinished_sentence(report.left, report.ranking, report.task.missed[1])
    return [*report.ranking.sentences()[: 1 if compared else 2], *compared, *filter(None, [unfinished])]


def _words(metric: str, of: str) -> str:
    """Return a figure in words."""
    kind, _, distance = metric.partition("_per_s_at_")
    plain = {
        "duration_s": "time",
        "collision_samples_per_s": "collisions per s",
        "collision_events_per_s": "events per s",
    }
    return f"{plain.get(metric, f'{kind} per s within {distance}')} of {of}"


def summary_of(report: Report) -> dict[str, Any]:
    """Return the content of `summary.json`; a missing figure is None."""
    return {
        **by_strategy(report.measured),
        "experiment": report.experiment.name,
        "seed": report.seed,
        "scenarios": len(report.scenarios),
        "conditions": {
            name: {
                "n": len(report.scenarios),
                "completed": int(report.figures["completed"][name].sum()),
                **{metric: asdict(summary) for metric, summary in own.items()},
            }
            for name, own in report.summaries.items()
        },
        "comparisons": [
            {"a": a, "b": b, "metric": metric, **ratio.content} for (a, b, metric), ratio in report.comparisons.items()
        ],
        "reference": [mean.content for mean in report.means],
        "reference_ratios": [ratio.content for ratio in report.ratios],
    }


def _meet(first: Interval | None, second: Interval | None) -> bool | None:
    if first is None or second is None:
        return None
    return first[0] <= second[1] and second[0] <= first[1]
