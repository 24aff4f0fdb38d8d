"""The figures of evaluations: of an experiment, of a family, and of strategies under disturbances."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from clean_swarm_env.config.families import UNDISTURBED, Disturbance
from train.analysis.family_report import EXCESS, FamilyReport
from train.analysis.report import ExperimentReport
from train.analysis.robustness_report import ROBUSTNESS_FIGURES, RobustnessReport
from train.analysis.runs import COST, Runs
from train.reports.charts import (
    TEXT_COLOUR,
    colour_of,
    draw_rows,
    error_bar,
    fit_axis,
    label_of,
    log_scale,
    panels,
)

LEGEND = "point: a mission, hollow if not completed; box: quartiles; diamond: mean with its 95 % interval"
MARKERS = "os^vDP*X"
"""Forms of points, in turn."""
AXES = {"completed": "completed", "duration_s": "duration [s]", "collision_events": "collision events"}
SIDEWAYS = 0.06
"""Distance of neighbouring strategies, as a share of the distance between levels."""


def draw_experiment(report: ExperimentReport) -> Figure:
    """Return duration, or cost, and collision samples of every scenario under every condition, the best first."""
    distance, paper = report.experiment.mission.counted_distances[0], report.experiment.reference
    first = (COST, "cost [s]") if report.measured else ("duration_s", "duration [s]")
    shown = (first, ("collision_samples_per_s", f"samples per s of pairs closer than {distance:g} m"))
    places = {name: report.conditions.index(name) for name in report.ranking.labels}
    with panels(1, 2, (12.0, 1.6 + 0.55 * len(places)), shared=True) as (figure, axes):
        _draw_runs(axes[0], report.runs, dict(shown), places, paper.figures if paper else {})
        figure.suptitle(report.runs.title)
        figure.supxlabel(LEGEND + (f"; x: {paper.source}" if paper else ""), fontsize=9, color="0.4")
        return figure


def draw_family(report: FamilyReport) -> Figure:
    """Return cost and duration of every mission under each strategy, the best first."""
    runs, shown = report.runs, {EXCESS: f"{report.compared} [s]", "duration_s": "duration [s]"}
    with panels(1, 2, (12.0, 1.6 + 0.42 * len(runs.conditions)), shared=True) as (figure, axes):
        _draw_runs(axes[0], runs, shown, {name: place for place, name in enumerate(runs.conditions)})
        figure.suptitle(f"{runs.title}. {LEGEND}", fontsize=9)
        return figure


def _draw_runs(
    columns: Sequence[Axes],
    runs: Runs,
    shown: Mapping[str, str],
    places: Mapping[str, int],
    published: Mapping[str, Mapping[str, Sequence[float]]] = MappingProxyType({}),
) -> None:
    """Draw the missions of all conditions.

    Args:
        columns: one for each figure.
        runs: the runs.
        shown: figure -> label of its axis.
        places: condition -> its place among all, for its colour; in the order of the rows.
        published: condition -> figure -> values that are drawn beside.

    """
    scenarios = [name for worlds in runs.names for name in worlds]
    unfinished = {name: own.max(axis=0).ravel() > 0.0 for name, own in runs.unfinished.items()}
    hollow = np.stack([unfinished[name] for name in places]) if unfinished else None
    for axes, (figure, label) in zip(columns, shown.items(), strict=True):
        table = runs.table(figure)
        values = np.stack([table[name].mean(axis=0).ravel() for name in places])
        draw_rows(axes, values, scenarios, list(places), list(places.values()), hollow)
        beside = [np.array(published.get(name, {}).get(figure, ())) for name in places]
        for row, own in enumerate(beside if published else ()):
            axes.plot(own, np.full(len(own), row + 0.4), "x", color=TEXT_COLOUR, ms=4)
        fit_axis(axes, np.concatenate([values.ravel(), *beside]))
        axes.set_xlabel(label)


def draw_robustness(report: RobustnessReport) -> Figure:
    """Return a column for each kind of disturbance, and a row for each figure."""
    every = report.robustness.disturbances
    kinds = {kind: [one for one in every if one.kind == kind] for kind in dict.fromkeys(one.kind for one in every)}
    size = (0.9 + 1.9 * len(kinds), 7.0)
    with panels(len(ROBUSTNESS_FIGURES), len(kinds), size, shared=True) as (figure, axes):
        for row, name in enumerate(ROBUSTNESS_FIGURES):
            for column, levels in enumerate(kinds.values()):
                _draw_levels(axes[row, column], report, name, levels)
            axes[row, 0].set_ylabel(AXES[name])
            if name == "completed":
                axes[row, 0].set_ylim(-0.03, 1.03)
            else:
                log_scale(axes[row, 0], "y")
        for column, kind in enumerate(kinds):
            axes[-1, column].set_xlabel(kind)
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
        return figure


def _draw_levels(axes: Axes, report: RobustnessReport, figure: str, levels: list[Disturbance]) -> None:
    names, labels = [UNDISTURBED, *(level.name for level in levels)], list(report.estimates[UNDISTURBED])
    for k, label in enumerate(labels):
        estimates = [report.estimates[name][label][figure] for name in names]
        places = np.arange(len(names)) + SIDEWAYS * (k - (len(labels) - 1) / 2)
        values = [estimate.value for estimate in estimates]
        spread = np.hstack([error_bar(estimate.value, estimate.ci95) for estimate in estimates])
        marker = MARKERS[k % len(MARKERS)]
        axes.errorbar(places, values, spread, label=label_of(label), color=colour_of(k), marker=marker, ms=4, lw=1)
    axes.set_xticks(range(len(names)), [UNDISTURBED, *(level.level for level in levels)], fontsize=8)
    axes.grid(axis="y")
