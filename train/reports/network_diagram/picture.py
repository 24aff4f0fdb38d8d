"""Drawing of placed panels with Matplotlib. Colours are those of Okabe and Ito; line styles repeat their meaning."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, Literal

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyBboxPatch, PathPatch
from matplotlib.path import Path as Curve

from train.reports.network_diagram.content import BoxKind, LinkKind, NetworkPanel
from train.reports.network_diagram.layout import (
    BORDER,
    FONT,
    FONT_SIZE,
    GAP,
    LINE,
    PADDING,
    PlacedBox,
    PlacedPanel,
    place_panel,
    port_heights,
    text_width,
)

PICTURE_SUFFIXES: Final = (".svg", ".png", ".pdf")
"""Endings of picture files."""
LEGEND_ROOM: Final = 34.0
"""Height of the legend under the panels [pt]."""
TEXT, FRAME = "#1b1b1b", "#6b6b6b"
FILLS: Final = {
    BoxKind.MECHANISM: "#f3e6ee",
    BoxKind.SENSOR: "#eceff1",
    BoxKind.CONDITION: "#fbf6d0",
    BoxKind.BEHAVIOUR: "#d4e9f7",
    BoxKind.COORDINATOR: "#fbe3bd",
    BoxKind.EFFECT: "#ffffff",
    BoxKind.GOAL: "#d2efe4",
}
STROKES: Final[dict[LinkKind, tuple[str, Literal["solid", "dashed", "dotted"]]]] = {
    LinkKind.READS: ("#9aa0a6", "solid"),
    LinkKind.NEEDED: ("#3c4043", "solid"),
    LinkKind.WISHED: ("#3c4043", "dotted"),
    LinkKind.RAISES: ("#0072B2", "solid"),
    LinkKind.LOWERS: ("#D55E00", "dashed"),
    LinkKind.HELPS: ("#009E73", "solid"),
    LinkKind.HINDERS: ("#CC79A7", "dashed"),
}
"""Colour and line style of each kind of link."""


def draw_panels(panels: Sequence[NetworkPanel]) -> Figure:
    """Return a figure with all panels, one below the other, and a legend; its size follows from the panels."""
    placed = [place_panel(panel) for panel in panels]
    used = [kind for kind in LinkKind if any(link.kind is kind for panel in panels for link in panel.links)]
    wide = max(*(panel.width for panel in placed), sum(text_width(kind.value) + 48.0 for kind in used) + 2 * BORDER)
    tall = sum(panel.height for panel in placed) + LEGEND_ROOM
    figure = Figure(figsize=(wide / 72.0, tall / 72.0), facecolor="white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, wide), ylim=(tall, 0.0))
    axes.axis("off")
    top = 0.0
    for panel in placed:
        _draw_panel(axes, panel, top)
        top += panel.height
    _draw_legend(axes, used, top + 0.4 * LEGEND_ROOM)
    return figure


def save_picture(figure: Figure, file: Path) -> None:
    """Write a figure to a file of one of `PICTURE_SUFFIXES`; equal figures give equal files. Raises OSError."""
    undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}[file.suffix]
    with mpl.rc_context({"svg.hashsalt": "clean-swarm", "pdf.fonttype": 42}):
        figure.savefig(file, dpi=150, metadata=undated)


def _draw_panel(axes: Axes, placed: PlacedPanel, top: float) -> None:
    axes.text(
        BORDER, top + 16.0, placed.panel.title, fontsize=11.0, parse_math=False, weight="bold", color=TEXT, va="center"
    )
    for heading, x in placed.headings:
        axes.text(x, top + 35.0, heading, fontsize=FONT_SIZE, weight="bold", color=FRAME, va="center", family=FONT)
    leaving = port_heights(placed, lambda start, end: (start, end))
    arriving = port_heights(placed, lambda start, end: (end, start))
    for link in placed.panel.links:
        start, end, key = placed.boxes[link.start], placed.boxes[link.end], (link.start, link.end)
        left = (start.x + start.width, top + leaving[key])
        right = (end.x, top + arriving[key])
        _draw_link(axes, left, right, link.kind)
    for box in placed.boxes.values():
        _draw_box(axes, box, top)


def _draw_box(axes: Axes, placed: PlacedBox, top: float) -> None:
    kind = placed.box.kind
    inset = 1.5
    patch = FancyBboxPatch(
        (placed.x + inset, top + placed.y + inset), placed.width - 2 * inset, placed.height - 2 * inset,
        boxstyle=f"round,pad={inset},rounding_size=3", facecolor=FILLS[kind], edgecolor=FRAME,
        linewidth=2.0 if kind is BoxKind.COORDINATOR else 0.8, zorder=3,
    )  # fmt: skip
    axes.add_patch(patch)
    for i, line in enumerate(placed.lines):
        axes.text(
            placed.x + PADDING, top + placed.y + 0.5 * PADDING + (i + 0.5) * LINE, line, fontsize=FONT_SIZE,
            family=FONT, weight="bold" if i < placed.bold else "normal",
            color=TEXT, parse_math=False, va="center_baseline", zorder=4,
        )  # fmt: skip


def _draw_link(axes: Axes, start: tuple[float, float], end: tuple[float, float], kind: LinkKind) -> None:
    """Draw a curve with horizontal ends and a small arrow head."""
    colour, style = STROKES[kind]
    tip = (end[0] - 4.0, end[1])
    bend = min(0.6 * GAP, 0.5 * (tip[0] - start[0]))
    points = [start, (start[0] + bend, start[1]), (tip[0] - bend, tip[1]), tip]
    curve = Curve(points, [Curve.MOVETO, Curve.CURVE4, Curve.CURVE4, Curve.CURVE4])
    axes.add_patch(PathPatch(curve, fill=False, edgecolor=colour, linestyle=style, linewidth=1.1, zorder=1))
    head = [(tip[0], tip[1] - 2.2), (end[0] + 0.5, end[1]), (tip[0], tip[1] + 2.2)]
    axes.fill(*zip(*head, strict=True), facecolor=colour, edgecolor="none", zorder=2)


def _draw_legend(axes: Axes, used: Sequence[LinkKind], y: float) -> None:
    x = BORDER
    for kind in used:
        colour, style = STROKES[kind]
        axes.add_line(Line2D([x, x + 22.0], [y, y], color=colour, linestyle=style, linewidth=1.4))
        axes.text(x + 27.0, y, kind.value, fontsize=FONT_SIZE, color=TEXT, va="center", family=FONT)
        x += text_width(kind.value) + 48.0
