"""The figures of evaluations: of an experiment, of a family, and of strategies under disturbances."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from clean_swarm_env.config.families import UNDISTURBED, Disturbance
from train.analysis.family_report import FIGURES, FamilyReport
from train.analysis.report import Report
from train.analysis.robustness_report import ROBUSTNESS_FIGURES, RobustnessReport
from train.analysis.statistics import COST
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

LEGEND = "diamond: mean with its 95 % interval; box: quartiles; grey line: one scenario; hollow point: not completed"
MARKERS = "os^vDP*X"
"""Forms of points, in turn."""
AXES = {"completed": "completed", "duration_s": "duration [s]", "collision_events": "collision events"}
SIDEWAYS = 0.06
"""Distance of neighbouring strategies, as a share of the distance between levels."""


def draw_experiment(report: Report) -> Figure:
    """Return duration, or cost, and collision samples of every scenario under every condition, the best first."""
    figures, distance = report.figures, report.experiment.mission.collision_distances[0]
    first = (COST, "cost [s]") if report.measured else ("duration_s", "duration [s]")
    shown = (first, ("collision_samples_per_s", f"samples per s of pairs closer than {distance:g} m"))
    count, paper, names = len(report.scenarios), report.experiment.reference, report.ranking.labels
    places = [report.conditions.index(name) for name in names]
    hollow = np.stack([figures["completed"][name] == 0.0 for name in names])
    with panels(1, 2, (12.0, 1.6 + 0.55 * len(names)), shared=True) as (figure, axes):
        for one, (metric, label) in zip(axes[0], shown, strict=True):
            values = np.stack([figures[metric][name] for name in names])
            draw_rows(one, values, report.scenarios, names, places, hollow)
            published = [np.array(paper.figures.get(name, {}).get(metric, ())) for name in names] if paper else []
            for row, own in enumerate(published):
                one.plot(own, np.full(len(own), row + 0.4), "x", color=TEXT_COLOUR, ms=4)
            fit_axis(one, np.concatenate([values.ravel(), *published]))
            one.set_xlabel(label)
        figure.suptitle(f"{report.experiment.name}: {count} scenario{'s' if count > 1 else ''}, seed {report.seed}")
        figure.supxlabel(LEGEND + (f"; x: {paper.source}" if paper else ""), fontsize=8, color="0.4")
        return figure


def draw_family(report: FamilyReport) -> Figure:
    """Return cost and duration of every mission under each strategy, the best first."""
    runs = report.runs
    names = list(runs.conditions)
    scenarios = [f"test-{k}.{world}" for k in range(runs.scenarios) for world in range(runs.worlds)]
    shown = {f"{report.compared} [s]": "excess_s", "duration [s]": "duration_s"}
    tables = {what: runs.table(FIGURES[figure]) for what, figure in shown.items()}
    with panels(1, 2, (12.0, 1.6 + 0.42 * len(names)), shared=True) as (figure, axes):
        for one, (what, table) in zip(axes[0], tables.items(), strict=True):
            values = np.stack([table[name].mean(axis=0).ravel() for name in names])
            hollow = np.stack([report.left[name].max(axis=0).ravel() > 0 for name in names]) if report.left else None
            draw_rows(one, values, scenarios, names, range(len(names)), hollow)
            fit_axis(one, values)
            one.set_xlabel(what)
        count = f"{runs.scenarios} scenario{'s' if runs.scenarios > 1 else ''}"
        figure.suptitle(f"{runs.family.name}: {count}, seed {runs.seed}. {LEGEND}", fontsize=8)
        return figure


def draw_robustness(report: RobustnessReport) -> Figure:
    """Return a column for each kind of disturbance, and a row for each figure."""
    kinds: dict[str, list[Disturbance]] = {}
    for disturbance in report.robustness.disturbances:
        kinds.setdefault(disturbance.kind, []).append(disturbance)
    size = (1.5 + 2.8 * len(kinds), 8.0)
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
