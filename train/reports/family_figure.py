"""The figure of an evaluation on a family: time and collisions of each strategy, and its cost over prices."""

import io

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from train.analysis.family_report import FamilyReport
from train.analysis.front import PRICES

PALETTE = mpl.colormaps["tab20"].colors  # type: ignore[attr-defined]


def draw_front(report: FamilyReport) -> bytes:
    """Return the figure as a PNG."""
    front, runs = report.front, report.runs
    colours = {label: PALETTE[k % len(PALETTE)] for k, label in enumerate(front.excesses)}
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(11.0, 4.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        for label, excesses in front.excesses.items():
            best = label in front.undominated
            left.scatter(
                excesses[0],
                front.events[label],
                color=colours[label],
                s=45 if best else 22,
                marker="D" if best else "o",
            )
            right.plot(range(len(PRICES)), excesses, color=colours[label], label=label, linewidth=1.3)
        along = sorted((front.excesses[label][0], front.events[label]) for label in front.undominated)
        left.step(
            [time for time, _ in along], [events for _, events in along], where="post", color="0.6", linewidth=0.8
        )
        left.set_xscale("log")
        left.set_yscale("symlog", linthresh=1.0)
        right.set_yscale("log")
        _describe(left, "excess without the price of collisions [s]", "collision events a mission")
        left.set_title("diamonds: no other has less time and fewer events", fontsize=8, color="0.3")
        _describe(right, "price of a collision event [s]", "excess cost [s]")
        right.set_xticks(range(len(PRICES)), [f"{price:g}" for price in PRICES])
        count = f"{runs.scenarios} scenario{'s' if runs.scenarios > 1 else ''}"
        figure.suptitle(f"{runs.family.name}: {count}, seed {runs.seed}")
        figure.legend(*right.get_legend_handles_labels(), loc="outside right upper", fontsize=7, frameon=False)
        image = io.BytesIO()
        figure.savefig(image, format="png", dpi=150, metadata={"Software": "clean-swarm"})
        return image.getvalue()


def _describe(axes: Axes, along: str, up: str) -> None:
    axes.set_xlabel(along)
    axes.set_ylabel(up)
