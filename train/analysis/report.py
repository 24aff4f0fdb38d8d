"""The report of an experiment: the content of `summary.json`, and the figures of the tables and the picture."""

import itertools
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from clean_swarm_env.config.experiment import ExperimentConfig
from train.analysis.reference import Measured, ReferenceComparison, compare_with_measured
from train.analysis.statistics import (
    METRICS,
    Figures,
    Ratio,
    Summary,
    distance_metrics,
    figures_of,
    ratio_of_means,
    summarise,
)
from train.running.runs import RunRecord


@dataclass(frozen=True)
class ConditionRatio:
    """Ratio of the means of one metric under the conditions a and b."""

    a: str
    b: str
    metric: str
    ratio: Ratio


@dataclass(frozen=True)
class Report:
    """All results of an evaluation."""

    experiment: ExperimentConfig
    seed: int
    figures: Figures
    summaries: dict[str, dict[str, Summary]]
    """Condition -> metric -> summary."""
    comparisons: tuple[ConditionRatio, ...]
    reference: ReferenceComparison
    measured: Measured
    own_starts: bool
    """Whether the scenarios are those of the experiment, for each of which figures may have been published."""


def report_of(
    experiment: ExperimentConfig, seed: int, records: Sequence[RunRecord], measured: Measured, *, own_starts: bool
) -> Report:
    """Return the report on the records of all runs; `measured` figures may be missing."""
    conditions = [condition.name for condition in experiment.conditions]
    distances = experiment.mission.collision_distances
    figures = figures_of(records, conditions, [start.id for start in experiment.starts], distances)
    summaries = {
        name: {metric: summarise(figures.values[metric][c]) for metric in METRICS} for c, name in enumerate(conditions)
    }
    comparisons = tuple(
        ConditionRatio(conditions[a], conditions[b], metric, ratio_of_means(*figures.values[metric][[a, b]]))
        for a, b in itertools.combinations(range(len(conditions)), 2)
        for metric in METRICS
    )
    reference = compare_with_measured(
        figures, measured, experiment.conditions, ["duration_s", *distance_metrics(distances)]
    )
    return Report(experiment, seed, figures, summaries, comparisons, reference, measured, own_starts)


def summary_json(report: Report) -> str:
    """Return the content of `summary.json`; a missing figure is null."""
    figures = report.figures
    content: dict[str, Any] = {
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
            {"a": c.a, "b": c.b, "metric": c.metric, "ratio": c.ratio.ratio, "ci95": c.ratio.ci95}
            for c in report.comparisons
        ],
        "reference": [asdict(mean) for mean in report.reference.means],
        "reference_ratios": [asdict(ratio) for ratio in report.reference.ratios],
    }
    return json.dumps(content, indent=2, allow_nan=False) + "\n"
