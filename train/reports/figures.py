"""The pictures of evaluations as PNG: of an experiment, of a family, and of strategies under disturbances."""

import numpy as np
from matplotlib.axes import Axes

from clean_swarm_env.config.families import UNDISTURBED, Disturbance
from train.analysis.family_report import PRICES, FamilyReport, Front
from train.analysis.report import Report
from train.analysis.robustness_report import ROBUSTNESS_FIGURES, RobustnessReport
from train.analysis.statistics import COST
from train.reports.charts import COLOURS, colour_of, draw_rows, error_bar, label_of, log_scale, panels, png

LEGEND = "diamond: mean with its 95 % interval; box: quartiles; grey line: one scenario; hollow point: not completed"
MARKERS, LINES = "os^vDP*X", ("-", "--", ":", "-.")
"""Form of the point and of the line with the first colours, the next ones, and so on."""
BOTTOM, BEYOND = -0.25, 1.6
"""Lower end of the axis of collision events; factor by which axes reach beyond the farthest point."""
ROBUSTNESS_LABELS = {"completed": "completed", "duration_s": "duration [s]", "collision_events": "collision events"}
"""Label of the axis of each figure."""
SIDEWAYS = 0.06
"""Distance of neighbouring strategies, as a share of the distance between levels."""


def draw_experiment(report: Report) -> bytes:
    """Return duration, or cost, and collision samples of every scenario under every condition."""
    figures, distance = report.figures, report.experiment.mission.collision_distances[0]
    first = (COST, "cost [s]") if report.measured_by_task else ("duration_s", "duration [s]")
    shown = (first, ("collision_samples_per_s", f"samples per s of pairs closer than {distance:g} m"))
    names, count = figures.conditions, len(figures.scenarios)
    with panels(1, 2, (12.0, 1.6 + 0.55 * len(names)), shared=True) as (figure, axes):
        for one, (metric, label) in zip(axes[0], shown, strict=True):
            draw_rows(one, figures.values[metric], figures.scenarios, names, range(len(names)), ~figures.completed)
            one.set_xlabel(label)
        log_scale(axes[0, 0], "x")
        axes[0, 1].set_xlim(left=0.0)
        figure.suptitle(f"{report.experiment.name}: {count} scenario{'s' if count > 1 else ''}, seed {report.seed}")
        figure.supxlabel(LEGEND, fontsize=8, color="0.4")
        return png(figure)


def draw_front(report: FamilyReport) -> bytes | None:
    """Return time and collisions of each strategy, and its cost over prices; None where costs have no such price."""
    front, runs = report.front, report.runs
    if front is None:
        return None
    with panels(1, 2, (11.0, 4.8)) as (figure, ((left, right),)):
        for k, (label, excesses) in enumerate(front.excesses.items()):
            turn = k // len(COLOURS)
            look = {"color": colour_of(k), "marker": MARKERS[turn % len(MARKERS)]}
            size, edge = (70, "black") if label in front.undominated else (30, colour_of(k))
            left.scatter(excesses[0], front.events[label], s=size, edgecolors=edge, zorder=2, **look)
            line = LINES[turn % len(LINES)]
            right.plot(range(len(PRICES)), excesses, ls=line, label=label_of(label), lw=1.3, ms=3.5, **look)
        _frame(left, front)
        left.set(xlabel="excess without the price of collisions [s]", ylabel="collision events a mission")
        left.set_title("black edge: no other has less time and fewer events", fontsize=8, color="0.3")
        log_scale(right, "y")
        right.set(xlabel="price of a collision event [s]", ylabel="excess cost [s]")
        right.set_xticks(range(len(PRICES)), [f"{price:g}" for price in PRICES])
        count = f"{runs.scenarios} scenario{'s' if runs.scenarios > 1 else ''}"
        figure.suptitle(f"{runs.family.name}: {count}, seed {runs.seed}")
        figure.legend(*right.get_legend_handles_labels(), loc="outside right upper", fontsize=7, frameon=False)
        return png(figure)


def _frame(axes: Axes, front: Front) -> None:
    """Draw the line along the best strategies, and make room for every point."""
    along = sorted((front.excesses[label][0], front.events[label]) for label in front.undominated)
    axes.step(*zip(*along, strict=True), where="post", color="0.6", linewidth=0.8, zorder=1)
    log_scale(axes, "x")
    axes.set_yscale("symlog", linthresh=1.0)
    axes.yaxis.set_major_formatter("{x:g}")
    times = [excesses[0] for excesses in front.excesses.values() if excesses[0] > 0.0]
    if times:
        axes.set_xlim(min(times) / BEYOND, max(times) * BEYOND)
    axes.set_ylim(BOTTOM, max(*front.events.values(), 1.0) * BEYOND)


def draw_robustness(report: RobustnessReport) -> bytes:
    """Return a column for each kind of disturbance, and a row for each figure."""
    kinds: dict[str, list[Disturbance]] = {}
    for disturbance in report.robustness.disturbances:
        kinds.setdefault(disturbance.kind, []).append(disturbance)
    size = (1.5 + 2.8 * len(kinds), 8.0)
    with panels(len(ROBUSTNESS_FIGURES), len(kinds), size, shared=True) as (figure, axes):
        for row, name in enumerate(ROBUSTNESS_FIGURES):
            for column, levels in enumerate(kinds.values()):
                _draw_levels(axes[row, column], report, name, levels)
            axes[row, 0].set_ylabel(ROBUSTNESS_LABELS[name])
            if name != "completed":
                log_scale(axes[row, 0], "y")
        for column, kind in enumerate(kinds):
            axes[-1, column].set_xlabel(kind)
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
        return png(figure, dpi=110)


def _draw_levels(axes: Axes, report: RobustnessReport, figure: str, levels: list[Disturbance]) -> None:
    names, labels = [UNDISTURBED, *(level.name for level in levels)], report.strategies
    for k, label in enumerate(labels):
        estimates = [report.estimates[name][label][figure] for name in names]
        places = np.arange(len(names)) + SIDEWAYS * (k - (len(labels) - 1) / 2)
        values = [estimate.value for estimate in estimates]
        spread = np.hstack([error_bar(estimate.value, estimate.ci95) for estimate in estimates])
        marker = MARKERS[k % len(MARKERS)]
        axes.errorbar(places, values, spread, label=label_of(label), color=colour_of(k), marker=marker, ms=4, lw=1)
    axes.set_xticks(range(len(names)), [UNDISTURBED, *(level.level for level in levels)], fontsize=8)
    axes.grid(axis="y")
