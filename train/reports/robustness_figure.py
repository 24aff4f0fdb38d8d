"""The figure of strategies under disturbances: a column for each kind of disturbance, a row for each figure."""

import io

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from clean_swarm_env.config.families import UNDISTURBED, Disturbance
from train.analysis.robustness_report import ROBUSTNESS_FIGURES, RobustnessReport

LABELS = {"completed": "completed", "duration_s": "duration [s]", "collision_events": "collision events"}
"""Label of the axis of each figure."""
SIDEWAYS = 0.06
"""Distance of neighbouring strategies, as a share of the distance between levels."""
MARKERS = "os^vDP*X"


def draw_robustness(report: RobustnessReport) -> bytes:
    """Return the figure as a PNG."""
    kinds: dict[str, list[Disturbance]] = {}
    for disturbance in report.runs.robustness.disturbances:
        kinds.setdefault(disturbance.kind, []).append(disturbance)
    with mpl.rc_context({"font.size": 10, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(1.5 + 2.8 * len(kinds), 8.0), layout="constrained")
        panels = figure.subplots(len(ROBUSTNESS_FIGURES), len(kinds), sharey="row", sharex="col", squeeze=False)
        for row, name in enumerate(ROBUSTNESS_FIGURES):
            for column, levels in enumerate(kinds.values()):
                _panel(panels[row, column], report, name, levels)
            panels[row, 0].set_ylabel(LABELS[name])
            if name != "completed":
                panels[row, 0].set_yscale("log")
        for column, kind in enumerate(kinds):
            panels[-1, column].set_xlabel(kind)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=3, frameon=False)
        image = io.BytesIO()
        figure.savefig(image, format="png", dpi=110, metadata={"Software": "clean-swarm"})
        return image.getvalue()


def _panel(axes: Axes, report: RobustnessReport, figure: str, levels: list[Disturbance]) -> None:
    names = [UNDISTURBED, *(level.name for level in levels)]
    labels = list(report.runs.conditions)
    for k, label in enumerate(labels):
        estimates = [report.estimates[name][label][figure] for name in names]
        places = [place + SIDEWAYS * (k - (len(labels) - 1) / 2) for place in range(len(names))]
        values = [estimate.value for estimate in estimates]
        ends = [estimate.ci95 or (estimate.value, estimate.value) for estimate in estimates]
        below = [value - low for value, (low, _) in zip(values, ends, strict=True)]
        above = [high - value for value, (_, high) in zip(values, ends, strict=True)]
        axes.errorbar(
            places,
            values,
            [below, above],
            label=label,
            color=f"C{k % 10}",
            marker=MARKERS[k % len(MARKERS)],
            markersize=4,
            linewidth=1,
        )
    axes.set_xticks(range(len(names)), [UNDISTURBED, *(level.level for level in levels)], fontsize=8)
    axes.grid(axis="y", color="0.92")
