"""The figure of an evaluation on a family: time and collisions of each strategy, and its cost over prices."""

import io

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from clean_swarm_env.drawing.canvas import OPTION_COLOURS
from train.analysis.family_report import FamilyReport
from train.analysis.front import PRICES, Front

COLOURS = tuple(colour for colour in OPTION_COLOURS if colour != "#F0E442")
"""Colours of strategies in turn; without the yellow, which is hardly seen on white."""
MARKERS, LINES = "os^v", ("-", "--", ":", "-.")
"""Form of the point and of the line with the first colours, the next ones, and so on."""
BOTTOM, BEYOND = -0.25, 1.6
"""Lower end of the axis of collision events; factor by which axes reach beyond the farthest point."""


def draw_front(report: FamilyReport) -> bytes | None:
    """Return the figure as a PNG; None where costs have no price of collisions."""
    front, runs = report.front, report.runs
    if front is None:
        return None
    with mpl.rc_context({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(11.0, 4.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        for k, (label, excesses) in enumerate(front.excesses.items()):
            row, place = divmod(k, len(COLOURS))
            marker, line, colour = MARKERS[row % len(MARKERS)], LINES[row % len(LINES)], COLOURS[place]
            size, edge = (70, "black") if label in front.undominated else (30, colour)
            look = {"color": colour, "marker": marker}
            left.scatter(excesses[0], front.events[label], s=size, edgecolors=edge, zorder=2, **look)
            right.plot(range(len(PRICES)), excesses, ls=line, label=label, lw=1.3, ms=3.5, **look)
        _frame(left, front)
        right.set_yscale("log")
        _describe(left, "excess without the price of collisions [s]", "collision events a mission")
        left.set_title("black edge: no other has less time and fewer events", fontsize=8, color="0.3")
        _describe(right, "price of a collision event [s]", "excess cost [s]")
        right.set_xticks(range(len(PRICES)), [f"{price:g}" for price in PRICES])
        count = f"{runs.scenarios} scenario{'s' if runs.scenarios > 1 else ''}"
        figure.suptitle(f"{runs.family.name}: {count}, seed {runs.seed}")
        figure.legend(*right.get_legend_handles_labels(), loc="outside right upper", fontsize=7, frameon=False)
        image = io.BytesIO()
        figure.savefig(image, format="png", dpi=150, metadata={"Software": "clean-swarm"})
        return image.getvalue()


def _frame(axes: Axes, front: Front) -> None:
    """Draw the line along the best strategies, and make room for every point."""
    along = sorted((front.excesses[label][0], front.events[label]) for label in front.undominated)
    axes.step(*zip(*along, strict=True), where="post", color="0.6", linewidth=0.8, zorder=1)
    axes.set_xscale("log")
    axes.set_yscale("symlog", linthresh=1.0)
    times = [excesses[0] for excesses in front.excesses.values() if excesses[0] > 0.0]
    if times:
        axes.set_xlim(min(times) / BEYOND, max(times) * BEYOND)
    axes.set_ylim(BOTTOM, max(*front.events.values(), 1.0) * BEYOND)


def _describe(axes: Axes, along: str, up: str) -> None:
    axes.set_xlabel(along)
    axes.set_ylabel(up)
