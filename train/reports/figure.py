"""The figure of an evaluation: duration and collision samples of every scenario under every condition."""

import io

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter

from selforg.arrays import Flags, Floats
from train.analysis.report import Report
from train.analysis.statistics import COST, Summary

COLOURS = ("#c44e52", "#4c72b0", "#55a868", "#dd8452", "#8172b3", "#937860")
"""Colours of the conditions, in order."""
LEGEND = "diamond: mean with its 95 % interval; box: quartiles; grey line: one scenario; hollow point: not completed"
SPREAD = 0.06
"""Half the width of the points of one condition, as a share of the distance between conditions."""


def draw(report: Report) -> bytes:
    """Return the figure as a PNG."""
    with mpl.rc_context({"font.size": 10, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(10.5, 5.2), layout="constrained")
        left, right = figure.subplots(1, 2)
        distance = report.experiment.mission.collision_distances[0]
        metric = COST if report.measured_by_task else "duration_s"
        _panel(left, report, metric, "cost [s]" if report.measured_by_task else "duration [s]")
        _panel(right, report, "collision_samples_per_s", f"samples per s of pairs closer than {distance:g} m")
        left.set_yscale("log")
        for choose in (left.yaxis.set_major_formatter, left.yaxis.set_minor_formatter):
            choose(LogFormatter(minor_thresholds=(2.0, 0.8), labelOnlyBase=False))
        right.set_ylim(bottom=0.0)
        count = len(report.figures.scenarios)
        figure.suptitle(f"{report.experiment.name}: {count} scenario{'s' if count > 1 else ''}, seed {report.seed}")
        figure.supxlabel(LEGEND, fontsize=8, color="0.4")
        image = io.BytesIO()
        figure.savefig(image, format="png", dpi=150, metadata={"Software": "clean-swarm"})
        return image.getvalue()


def _panel(axes: Axes, report: Report, metric: str, label: str) -> None:
    values = report.figures.values[metric]
    places = np.arange(len(values))[:, None] + _offsets(values.shape[1])
    axes.plot(places, values, color="0.75", linewidth=0.7, alpha=max(0.15, min(0.8, 12 / values.shape[1])), zorder=1)
    boxes = axes.boxplot(list(values), positions=range(len(values)), widths=0.4, showfliers=False, patch_artist=True)
    for line in (*boxes["whiskers"], *boxes["caps"]):
        line.set(color="0.6")
    for c, name in enumerate(report.figures.conditions):
        colour = COLOURS[c % len(COLOURS)]
        boxes["boxes"][c].set(facecolor=colour, alpha=0.2, edgecolor=colour)
        boxes["medians"][c].set(color=colour, linewidth=2)
        _points(axes, places[c], values[c], report.figures.completed[c], colour)
        _mean(axes, c + 0.3, report.summaries[name][metric], colour)
    axes.set_xticks(range(len(values)), [name.replace("-", "\n", 1) for name in report.figures.conditions])
    axes.tick_params(axis="x", labelsize=10 if len(values) < 3 else 8)
    axes.set_xlim(-0.5, len(values) - 0.3)
    axes.set_ylabel(label)
    axes.set_title(_ratio_line(report, metric), fontsize=9, color="0.3")


def _points(axes: Axes, places: Floats, values: Floats, completed: Flags, colour: str) -> None:
    axes.scatter(places[completed], values[completed], s=16, color=colour, alpha=0.75, linewidths=0, zorder=3)
    axes.scatter(places[~completed], values[~completed], s=22, facecolors="none", edgecolors=colour, zorder=3)


def _mean(axes: Axes, place: float, summary: Summary, colour: str) -> None:
    low, high = summary.ci95 or (summary.mean, summary.mean)
    above = max(low, axes.get_ylim()[0], summary.mean / 20.0)  # 0 cannot be drawn on a log axis
    axes.plot([place, place], [above, high], color=colour, linewidth=2, zorder=4)
    axes.plot(place, summary.mean, marker="D", color=colour, markeredgecolor="white", markersize=8, zorder=5)
    text = f"{summary.mean:.0f}" if summary.mean >= 100.0 else f"{summary.mean:.3g}"
    axes.annotate(text, (place, summary.mean), (8, 0), textcoords="offset points", va="center")


def _offsets(count: int) -> Floats:
    """Return sideways offsets (K,) that separate neighbouring scenarios, the same for every condition."""
    offsets: Floats = SPREAD * np.cos(np.arange(count) * np.pi * (3.0 - np.sqrt(5.0)))
    return offsets


def _ratio_line(report: Report, metric: str) -> str:
    """Return the ratios of all conditions to the last one."""
    last = report.figures.conditions[-1]
    return "\n".join(
        f"{c.a} / {c.b}: {c.ratio.ratio:.2f}"
        + (f" [{c.ratio.ci95[0]:.2f}, {c.ratio.ci95[1]:.2f}]" if c.ratio.ci95 else "")
        for c in report.comparisons
        if c.metric == metric and c.b == last and c.ratio.ratio is not None
    )
