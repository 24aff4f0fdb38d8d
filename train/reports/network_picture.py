"""Pictures of networks: columns of boxes, those that are linked near each other, drawn by Matplotlib.

All lengths are points (1/72 inch); y grows downwards. Text is measured in its font, so that it fits into its box.
Colours are those of Okabe and Ito; line styles repeat their meaning.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from textwrap import wrap
from typing import Final, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import FancyBboxPatch, PathPatch
from matplotlib.path import Path as Curve
from matplotlib.textpath import TextPath
from scipy.optimize import isotonic_regression

from train.reports.network_content import BoxKind, DiagramBox, LinkKind, NetworkPanel

FONT, FONT_SIZE, LINE = "DejaVu Sans", 8.0, 11.0
"""Font, its size and the distance of lines [pt]."""
PADDING, BETWEEN, GAP = 6.0, 8.0, 62.0
"""Inside a box, between boxes of a column, and between columns [pt]."""
HEADING, BORDER, LEGEND_ROOM = 46.0, 16.0, 34.0
"""Space for title and headings above the boxes, around the panel, and for the legend under the panels [pt]."""
PORTS, INSET = 7.0, 1.5
"""Largest distance of links where they touch a box, and the inset of its frame [pt]."""
LETTERS = 40
"""Most letters of a line."""
SCREEN_ROUNDING = 1.04
"""Factor on the width of a line, because screens round the widths of its letters."""
TEXT, FRAME = "#1b1b1b", "#6b6b6b"
FILLS: Final[dict[BoxKind, str]] = {
    "mechanisms and targets": "#f3e6ee",
    "sensors": "#eceff1",
    "preconditions": "#fbf6d0",
    "behaviours": "#d4e9f7",
    "coordinators": "#fbe3bd",
    "effects": "#ffffff",
    "goals": "#d2efe4",
}
STROKES: Final[dict[LinkKind, tuple[str, Literal["solid", "dashed", "dotted"]]]] = {
    "is read by": ("#9aa0a6", "solid"),
    "is needed by": ("#3c4043", "solid"),
    "optional: adds its wish only": ("#3c4043", "dotted"),
    "effect: raises": ("#0072B2", "solid"),
    "effect: lowers": ("#D55E00", "dashed"),
    "helps the goal": ("#009E73", "solid"),
    "hinders the goal": ("#CC79A7", "dashed"),
}
"""Colour and line style of each kind of link."""


@dataclass
class PlacedBox:
    """A box with its upper left corner and its size [pt]; of its broken lines the first `bold` are bold."""

    box: DiagramBox
    lines: list[str]
    bold: int
    x: float = 0.0
    y: float = 0.0
    width: float = 0.0

    @classmethod
    def of(cls, box: DiagramBox) -> "PlacedBox":
        """Return a box with broken lines, not yet placed; the first line of most is a name, which is bold."""
        broken = [wrap(line, LETTERS, subsequent_indent="  ") or [""] for line in box.lines]
        bold = 0 if box.kind in ("preconditions", "effects") else len(broken[0])
        return cls(box, [part for line in broken for part in line], bold)

    @property
    def height(self) -> float:
        """Its height [pt]."""
        return len(self.lines) * LINE + PADDING

    @property
    def middle(self) -> float:
        """Vertical position of the middle [pt]."""
        return self.y + 0.5 * self.height


def draw_panels(panels: Sequence[NetworkPanel]) -> Figure:
    """Return a figure with all panels, one below the other, and a legend; its size follows from the panels."""
    tops, placed = [0.0], list[dict[str, PlacedBox]]()
    for panel in panels:
        placed.append(place_boxes(panel, tops[-1]))
        tops.append(BORDER + max(box.y + box.height for box in placed[-1].values()))
    tall = tops[-1]
    used = [kind for kind in STROKES if any(kind in panel.links.values() for panel in panels)]
    right = max(box.x + box.width for boxes in placed for box in boxes.values())
    wide = max(right + BORDER, sum(text_width(kind) + 48.0 for kind in used) + 2 * BORDER)
    figure = Figure(figsize=(wide / 72.0, (tall + LEGEND_ROOM) / 72.0), facecolor="white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, wide), ylim=(tall + LEGEND_ROOM, 0.0))
    axes.axis("off")
    for panel, boxes, top in zip(panels, placed, tops, strict=False):
        _draw_panel(axes, panel, boxes, top)
    x, y = BORDER, tall + 0.4 * LEGEND_ROOM
    for kind in used:
        colour, style = STROKES[kind]
        axes.plot([x, x + 22.0], [y, y], color=colour, linestyle=style, linewidth=1.4)
        _write(axes, x + 27.0, y, kind)
        x += text_width(kind) + 48.0
    return figure


def place_boxes(panel: NetworkPanel, top: float = 0.0) -> dict[str, PlacedBox]:
    """Return the boxes of a panel that begins at `top`, by their keys.

    The behaviours (the column with most links) keep the order of the document; every other column is ordered and placed
    by the mean height of the boxes to which its boxes are linked.
    """
    columns = [[PlacedBox.of(box) for box in column] for column in panel.columns]
    x, heights = BORDER, [np.array([box.height + BETWEEN for box in column]) for column in columns]
    tall = max(own.sum() for own in heights)
    for column in columns:
        width = 2.0 * PADDING + max(text_width(line, k < b.bold) for b in column for k, line in enumerate(b.lines))
        for box in column:
            box.x, box.width = x, width
        x += max(width, text_width(_heading([box.box for box in column]), bold=True)) + GAP
    main = next(i for i, column in enumerate(columns) if column[0].box.kind in ("behaviours", "coordinators"))
    placed: dict[str, PlacedBox] = {}
    for i in sorted(range(len(columns)), key=lambda i: abs(i - main)):
        column, own = columns[i], heights[i]
        slack = tall - own.sum()
        shifts = slack * (np.arange(len(column)) + 0.5) / len(column)
        if i != main:
            wanted = np.array([_neighbours(panel, box, placed, top + HEADING + tall) for box in column])
            order = np.argsort(wanted, kind="stable")
            column, own = [column[k] for k in order], own[order]
            begins = np.cumsum(own) - 0.5 * own + top + HEADING - 0.5 * BETWEEN
            shifts = np.clip(isotonic_regression(wanted[order] - begins).x, 0.0, slack)
        for box, y in zip(column, np.cumsum(own) - own + shifts + top + HEADING, strict=True):
            box.y, placed[box.box.key] = float(y), box
    return placed


def _neighbours(panel: NetworkPanel, box: PlacedBox, placed: Mapping[str, PlacedBox], lowest: float) -> float:
    """Return the mean height of the middles of the `placed` boxes to which a box is linked; `lowest` without links."""
    ends = [end if start == box.box.key else start for start, end in panel.links if box.box.key in (start, end)]
    return float(np.mean([placed[key].middle for key in ends if key in placed] or [lowest]))


def _heading(column: Sequence[DiagramBox]) -> str:
    return " and ".join(kind for kind in FILLS if any(box.kind == kind for box in column))


@cache
def text_width(text: str, bold: bool = False) -> float:
    """Return the width of a line of text [pt]."""
    if not text.strip():  # Matplotlib cannot measure empty text
        return 0.0
    font = FontProperties(family=FONT, weight="bold" if bold else "normal")
    plain = text.replace("$", r"\$")  # not the beginning of a formula
    return SCREEN_ROUNDING * float(TextPath((0.0, 0.0), plain, size=FONT_SIZE, prop=font).get_extents().x1)


def _draw_panel(axes: Axes, panel: NetworkPanel, boxes: Mapping[str, PlacedBox], top: float) -> None:
    axes.text(BORDER, top + 16.0, panel.title, fontsize=11.0, weight="bold", color=TEXT, va="center", parse_math=False)
    for column in panel.columns:
        _write(axes, boxes[column[0].key].x, top + 35.0, _heading(column), "bold", FRAME)
    leaving, arriving = (_port_heights(panel, boxes, side) for side in (0, 1))
    for (start, end), kind in panel.links.items():
        left = (boxes[start].x + boxes[start].width, leaving[start, end])
        _draw_link(axes, left, (boxes[end].x, arriving[start, end]), kind)
    for placed in boxes.values():
        thick = 2.0 if placed.box.kind == "coordinators" else 0.8
        axes.add_patch(FancyBboxPatch(
            (placed.x + INSET, placed.y + INSET), placed.width - 2 * INSET, placed.height - 2 * INSET,
            boxstyle=f"round,pad={INSET},rounding_size=3", facecolor=FILLS[placed.box.kind], edgecolor=FRAME,
            linewidth=thick, zorder=3,
        ))  # fmt: skip
        for k, line in enumerate(placed.lines):
            y = placed.y + 0.5 * PADDING + (k + 0.5) * LINE
            _write(axes, placed.x + PADDING, y, line, "bold" if k < placed.bold else "normal")


def _write(axes: Axes, x: float, y: float, text: str, weight: str = "normal", colour: str = TEXT) -> None:
    axes.text(
        x, y, text, fontsize=FONT_SIZE, family=FONT, weight=weight, color=colour, va="center_baseline", zorder=4,
        parse_math=False,
    )  # fmt: skip


def _port_heights(panel: NetworkPanel, boxes: Mapping[str, PlacedBox], side: int) -> dict[tuple[str, str], float]:
    """Return the height [pt] at which each link touches its box of a `side`: 0 its start, 1 its end.

    Links touch a box in the order of their other ends, so that they do not cross there.
    """
    meeting: dict[str, list[tuple[str, str]]] = {}
    for link in sorted(panel.links, key=lambda link: boxes[link[1 - side]].middle):
        meeting.setdefault(link[side], []).append(link)
    heights = {}
    for key, links in meeting.items():
        step = min(PORTS, (boxes[key].height - 6.0) / len(links))
        for k, link in enumerate(links):
            heights[link] = boxes[key].middle + step * (k - 0.5 * (len(links) - 1))
    return heights


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
