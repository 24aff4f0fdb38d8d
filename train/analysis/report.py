"""The report of an experiment: the content of `summary.json`, and the figures of the tables and the picture.

It compares our figures with those that another implementation measured on the same start configurations. Only the
scenarios that have the figure on both sides count. Means agree when 1 lies in the interval of their ratio (scenarios
drawn in pairs); ratios between two conditions agree when their two intervals meet.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from clean_swarm_env.config.experiment import ExperimentConfig
from selforg.arrays import Floats
from train.analysis.intervals import Interval, Ratio
from train.analysis.runs import COST, METRICS, Measured, Report, distance_metrics
from train.analysis.statistics import summarise
from train.analysis.task_report import by_strategy
from train.analysis.verdict import MOST_NAMED, Ranking, amount, unfinished_sentence


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
class ExperimentReport(Report):
    """All results of an experiment."""

    published: Measured
    """Figures that were measured on the same starts, by the conditions' names there."""
    own_starts: bool
    """Whether the scenarios are those of the experiment, for each of which figures may have been published."""

    @property
    def experiment(self) -> ExperimentConfig:
        """The experiment."""
        assert isinstance(self.runs.document, ExperimentConfig)
        return self.runs.document

    @property
    def conditions(self) -> list[str]:
        """The names of the conditions."""
        return list(self.runs.conditions)

    @property
    def scenarios(self) -> list[str]:
        """The names (K,) of the scenarios."""
        return [name for (name,) in self.runs.names]

    @property
    def metrics(self) -> tuple[str, ...]:
        """The figures that are compared, first that of the ranking: those of cleaning, or the cost of a task."""
        return (COST,) if self.runs.task.measures else METRICS

    @property
    def summarised(self) -> list[str]:
        """The figures of cleaning, and of a task."""
        return list(dict.fromkeys((*METRICS, *self.metrics, *(measure.name for measure in self.runs.task.measures))))

    @cached_property
    def comparisons(self) -> dict[tuple[str, str, str], Ratio]:
        """Conditions a and b, metric -> ratio of the means."""
        left = self.runs.unfinished
        return {
            (a, b, metric): Ratio.between(a, b, self.runs.table(metric), left if metric == METRICS[0] else None)
            for a, b in itertools.combinations(self.conditions, 2)
            for metric in self.metrics
        }

    @cached_property
    def ranking(self) -> Ranking:
        """The conditions by their duration, or by the cost of a task."""
        metric = self.metrics[0]
        return Ranking.of(self.runs.table(metric), "costs" if metric == COST else "takes", left=self.runs.censored)

    @cached_property
    def paired(self) -> bool:
        """Whether figures were measured on the same starts; if not, those of the paper stand beside ours, if any."""
        return any(self._measured(*each) for each in itertools.product(self.conditions, self._distances))

    @property
    def _distances(self) -> list[str]:
        return [METRICS[0], *distance_metrics(self.experiment.mission.counted_distances)]

    @cached_property
    def means(self) -> list[Agreement]:
        """Means beside those that were measured or published; empty without them."""
        both = itertools.product(self.conditions, self._distances if self.paired else METRICS)
        return [self._mean(*each) for each in both if self.beside(*each)]

    @cached_property
    def ratios(self) -> list[Agreement]:
        """Ratios of two conditions beside those of measured or published figures of both; empty without them."""
        return [
            self._ratio(a, b, metric)
            for a, b in itertools.combinations(self.conditions, 2)
            for metric in (self._distances if self.paired else METRICS)
            if self.beside(a, metric).keys() & self.beside(b, metric).keys()
        ]

    @property
    def agreements(self) -> list[Agreement]:
        """All there is beside our figures."""
        return [*self.means, *(one for one in self.ratios if math.isfinite(one.ours + one.theirs))]

    def ours(self, condition: str, metric: str) -> dict[str, float]:
        """Return scenario -> our figure."""
        return dict(zip(self.scenarios, self.runs.values(metric)[condition].tolist(), strict=True))

    def beside(self, condition: str, metric: str) -> dict[str, float]:
        """Return scenario, or what stands for one whose start is not known -> the figure beside ours."""
        if self.paired:
            return self._measured(condition, metric)
        paper, own = self.experiment.reference, self.scenarios if self.own_starts else []
        values = paper.figures.get(condition, {}).get(metric, ()) if paper else ()
        return {own[k] if k < len(own) else f"{k} of the paper": value for k, value in enumerate(values)}

    def _measured(self, condition: str, metric: str) -> dict[str, float]:
        (key,) = (each.measured or "" for each in self.experiment.conditions if each.name == condition)
        found = {scenario: self.published.get(scenario, {}).get(key, {}).get(metric) for scenario in self.scenarios}
        return {scenario: value for scenario, value in found.items() if value is not None}

    def _mean(self, condition: str, metric: str) -> Agreement:
        theirs, ours = self.beside(condition, metric), self.ours(condition, metric)
        values, beside = _values(ours, [*(theirs if self.paired else ours)]), _values(theirs, [*theirs])
        mine, other = summarise(values), summarise(beside)
        agrees, content = _meet(mine.ci95, other.ci95), {"condition": condition, "metric": metric, "n": len(values)}
        if self.paired:
            found = Ratio.of(values, beside)
            agrees = _meet(found.ci95, (1.0, 1.0))
            content |= {"ours": mine.mean, "measured": other.mean, "ratio": found.ratio, "ci95": found.ci95}
        return Agreement(_words(metric, condition), mine.mean, other.mean, agrees, {**content, "agrees": agrees})

    def _ratio(self, a: str, b: str, metric: str) -> Agreement:
        first, second = self.beside(a, metric), self.beside(b, metric)
        both = [scenario for scenario in first if scenario in second]
        names = both if self.paired else self.scenarios
        ours = Ratio.of(_values(self.ours(a, metric), names), _values(self.ours(b, metric), names))
        theirs = Ratio.of(_values(first, both), _values(second, both))
        agrees = _meet(ours.ci95, theirs.ci95)
        content = {"a": a, "b": b, "metric": metric, "n": len(both), "ours": ours.content, "measured": theirs.content}
        mine, other = (math.nan if one.ratio is None else one.ratio for one in (ours, theirs))
        return Agreement(_words(metric, f"{a} / {b}"), mine, other, agrees, {**content, "agrees": agrees})


def _values(figures: Mapping[str, float], scenarios: Sequence[str]) -> Floats:
    return np.array([figures[scenario] for scenario in scenarios])


def verdict_of(report: ExperimentReport) -> list[str]:
    """Return what came out, in one to three sentences; four where missions of a compared experiment were lost."""
    source = "measured" if report.paired else "the paper"
    those = source if report.paired else f"of {source} (95 % intervals meet)"
    known = [one for one in report.agreements if one.agrees is not None]
    others = [f"{one.what} ({amount(one.ours)}, {source} {amount(one.theirs)})" for one in known if not one.agrees]
    said = f"{len(known) - len(others)} of {len(known)} figures agree with those {those}"
    compared = [f"{said}{'; these do not: ' * bool(others)}{', '.join(others[:MOST_NAMED])}."] if known else []
    lost = any(own.any() for own in report.runs.unfinished.values())
    unfinished = unfinished_sentence(report.runs.unfinished, report.ranking, report.runs.task.missed[1])
    return [*report.ranking.sentences(), *compared, *([unfinished] if unfinished and (lost or not compared) else [])]


def _words(metric: str, of: str) -> str:
    """Return a figure in words."""
    kind, _, distance = metric.partition("_per_s_at_")
    plain = {
        "duration_s": "time",
        "collision_samples_per_s": "collisions per s",
        "collision_events_per_s": "events per s",
    }
    return f"{plain.get(metric, f'{kind} per s within {distance}')} of {of}"


def summary_of(report: ExperimentReport) -> dict[str, Any]:
    """Return the content of `summary.json`; a missing figure is None."""
    completed = report.runs.values("completed")
    return {
        **by_strategy(report.measured),
        "experiment": report.experiment.name,
        "seed": report.runs.seed,
        "scenarios": len(report.scenarios),
        "conditions": {
            name: {"n": len(report.scenarios), "completed": int(completed[name].sum()), **own}
            for name, own in report.summary.items()
        },
        "comparisons": [
            {"a": a, "b": b, "metric": metric, **ratio.content} for (a, b, metric), ratio in report.comparisons.items()
        ],
        "reference": [mean.content for mean in report.means if report.paired],
        "reference_ratios": [ratio.content for ratio in report.ratios if report.paired],
    }


def _meet(first: Interval | None, second: Interval | None) -> bool | None:
    if first is None or second is None:
        return None
    return first[0] <= second[1] and second[0] <= first[1]
