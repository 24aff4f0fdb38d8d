"""The report of an experiment: the content of `summary.json`, and the figures of the tables and the picture.

It compares our figures with those that another implementation measured on the same start configurations. Only the
scenarios that have the figure on both sides count. Means agree when 1 lies in the interval of their ratio (scenarios
drawn in pairs); ratios between two conditions agree when their two intervals meet.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from clean_swarm_env.config.experiment import ConditionConfig, ExperimentConfig
from clean_swarm_env.world.task import Task, task_class
from selector.documents.trust import BASELINE
from selforg.arrays import Flags, Floats
from train.analysis.intervals import Interval, Ratio
from train.analysis.statistics import (
    COST,
    METRICS,
    Figures,
    Summary,
    distance_metrics,
    figures_of,
    summarise,
)
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
    left: Mapping[str, Floats]
    """Condition -> 1 where a mission was not completed (1, K, 1), else 0; nothing where garbage keeps coming."""
    summaries: dict[str, dict[str, Summary]]
    """Condition -> metric -> summary."""
    comparisons: Mapping[tuple[str, str, str], Ratio]
    """Conditions a and b, metric -> ratio of the means."""
    means: Sequence[Agreement]
    ratios: Sequence[Agreement]
    """Comparisons with measured figures; empty without them."""
    measured: Measured
    own_starts: bool
    """Whether the scenarios are those of the experiment, for each of which figures may have been published."""
    measured_by_task: Sequence[MeasuredStrategy]
    """Measures of the task under each condition; empty for a task that has prices instead."""

    @property
    def task(self) -> type[Task[Any, Any]]:
        """The class of the task."""
        return task_class(self.experiment.mission)


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


def ranking_of_conditions(report: Report) -> Ranking:
    """Return the conditions by their duration, or by the cost of a task."""
    metric, verb = (COST, "costs") if report.measured_by_task else ("duration_s", "takes")
    values = dict(zip(report.figures.conditions, report.figures.values[metric], strict=True))
    return Ranking.of(values, verb, left={} if report.measured_by_task else report.left)


def verdict_of(report: Report) -> list[str]:
    """Return what came out, in one to three sentences."""
    ranking, agreed = ranking_of_conditions(report), agreements(report)
    source = "measured" if report.means else "the paper"
    those = source if report.means else f"of {source} (95 % intervals meet)"
    known = [one for one in agreed if one.agrees is not None]
    others = [f"{one.what} ({amount(one.ours)}, {source} {amount(one.theirs)})" for one in known if not one.agrees]
    said = f"{len(known) - len(others)} of {len(known)} figures agree with those {those}"
    compared = [f"{said}{'; not: ' * bool(others)}{'; '.join(others[:MOST_NAMED])}."] if known else []
    unfinished = unfinished_sentence(report.left, ranking, report.task.missed[1])
    return [*ranking.sentences()[: 1 if compared else 2], *compared, *filter(None, [unfinished])]


def _words(metric: str, of: str) -> str:
    """Return a figure in words."""
    kind, _, distance = metric.partition("_per_s_at_")
    plain = {
        "duration_s": "time",
        "collision_samples_per_s": "collisions per s",
        "collision_events_per_s": "events per s",
    }
    return f"{plain.get(metric, f'{kind} per s within {distance}')} of {of}"


def report_of(
    experiment: ExperimentConfig, seed: int, records: Sequence[RunRecord], measured: Measured, *, own_starts: bool
) -> Report:
    """Return the report on the records of all runs; `measured` figures may be missing."""
    conditions = [condition.name for condition in experiment.conditions]
    distances = experiment.mission.collision_distances
    figures = figures_of(records, conditions, [start.id for start in experiment.starts], distances)
    measures = task_class(experiment.mission).measures
    compared = (COST,) if measures else METRICS
    summarised = (*METRICS, *((COST, *(measure.name for measure in measures)) if measures else ()))
    summaries = {
        name: {metric: summarise(figures.values[metric][c]) for metric in summarised}
        for c, name in enumerate(conditions)
    }
    left: dict[str, Floats] = {}
    if not experiment.mission.items.keep_coming:
        left = dict(zip(conditions, 1.0 - figures.completed[:, None, :, None], strict=True))
    comparisons = {
        (a, b, metric): Ratio.between(
            a,
            b,
            dict(zip(conditions, figures.values[metric], strict=True)),
            left if metric == "duration_s" else None,
        )
        for a, b in itertools.combinations(conditions, 2)
        for metric in compared
    }
    theirs = _compared_with_measured(
        figures, measured, experiment.conditions, ["duration_s", *distance_metrics(distances)]
    )
    baseline = next((each.name for each in experiment.conditions if each.strategy == BASELINE), "")
    values = {
        name: {measure.name: figures.values[measure.name][c] for measure in measures}
        for c, name in enumerate(conditions)
    }
    of_task = measured_strategies(measures, values, baseline)
    return Report(experiment, seed, figures, left, summaries, comparisons, *theirs, measured, own_starts, of_task)


def summary_of(report: Report) -> dict[str, Any]:
    """Return the content of `summary.json`; a missing figure is None."""
    figures = report.figures
    return {
        **by_strategy(report.measured_by_task),
        "experiment": report.experiment.name,
        "seed": report.seed,
        "scenarios": len(figures.scenarios),
        "conditions": {
            name: {
                "n": len(figures.scenarios),
                "completed": int(figures.completed[c].sum()),
                **{metric: asdict(summary) for metric, summary in report.summaries[name].items()},
            }
            for c, name in enumerate(figures.conditions)
        },
        "comparisons": [
            {"a": a, "b": b, "metric": metric, **ratio.content} for (a, b, metric), ratio in report.comparisons.items()
        ],
        "reference": [mean.content for mean in report.means],
        "reference_ratios": [ratio.content for ratio in report.ratios],
    }


def _compared_with_measured(
    figures: Figures, measured: Measured, conditions: Sequence[ConditionConfig], metrics: Sequence[str]
) -> tuple[list[Agreement], list[Agreement]]:
    """Compare each metric under each condition, and its ratio between any two conditions, with what was measured."""
    found = {
        (condition.name, metric): _beside_measured(figures, measured, condition, metric)
        for condition in conditions
        for metric in metrics
    }
    means = [_mean(*key, values) for key, values in found.items() if values[2].any()]
    pairs = itertools.combinations([condition.name for condition in conditions], 2)
    both = [(a, b, metric, found[a, metric], found[b, metric]) for a, b in pairs for metric in metrics]
    return means, [_ratio(*each) for each in both if (each[3][2] & each[4][2]).any()]


Beside = tuple[Floats, Floats, Flags]
"""Our values, the measured ones, and whether each of these exists (K,)."""


def _beside_measured(figures: Figures, measured: Measured, condition: ConditionConfig, metric: str) -> Beside:
    found = [measured.get(s, {}).get(condition.measured or "", {}).get(metric) for s in figures.scenarios]
    values, exist = [0.0 if value is None else value for value in found], [value is not None for value in found]
    return figures.values[metric][figures.conditions.index(condition.name)], np.array(values), np.array(exist)


def _mean(condition: str, metric: str, both: Beside) -> Agreement:
    ours, theirs = (values[both[2]] for values in both[:2])
    found, (mine, other) = Ratio.of(ours, theirs), (float(ours.mean()), float(theirs.mean()))
    agrees = None if found.ci95 is None else found.ci95[0] <= 1.0 <= found.ci95[1]
    content = {"condition": condition, "metric": metric, "n": len(ours), "ours": mine, "measured": other}
    content |= {"ratio": found.ratio, "ci95": found.ci95, "agrees": agrees}
    return Agreement(_words(metric, condition), mine, other, agrees, content)


def _ratio(a: str, b: str, metric: str, first: Beside, second: Beside) -> Agreement:
    both = first[2] & second[2]
    ours, theirs = (Ratio.of(one[both], other[both]) for one, other in zip(first[:2], second[:2], strict=True))
    agrees = _meet(ours.ci95, theirs.ci95)
    content = {"a": a, "b": b, "metric": metric, "n": int(both.sum()), "ours": ours.content, "measured": theirs.content}
    mine, other = (math.nan if one.ratio is None else one.ratio for one in (ours, theirs))
    return Agreement(_words(metric, f"{a} / {b}"), mine, other, agrees, {**content, "agrees": agrees})


def _meet(first: Interval | None, second: Interval | None) -> bool | None:
    if first is None or second is None:
        return None
    return first[0] <= second[1] and second[0] <= first[1]
