"""The layout of a panel: columns from left to right, without overlaps, and linked boxes near each other.

All lengths are points (1/72 inch); y grows downwards. Text is measured in its font, so that it fits into its box.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from textwrap import wrap

from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from train.reports.network_diagram.content import BoxKind, DiagramBox, NetworkPanel

FONT, FONT_SIZE, LINE = "DejaVu Sans", 8.0, 11.0
"""Font, its size and the distance of lines [pt]."""
PADDING, BETWEEN, GAP = 6.0, 8.0, 62.0
"""Inside a box, between boxes of a column, and between columns [pt]."""
HEADING, BORDER = 46.0, 16.0
"""Space for title and headings above the boxes, and around the panel [pt]."""
LETTERS = 40
"""Most letters of a line."""
SCREEN_ROUNDING = 1.04
"""Factor on the width of a line, because screens round the widths of its letters."""
NAMELESS = (BoxKind.CONDITION, BoxKind.EFFECT)
"""Boxes whose first line is not a name."""


@dataclass(frozen=True)
class PlacedBox:
    """A box with its upper left corner, its size [pt] and its broken lines, of which the first `bold` are bold."""

    box: DiagramBox
    x: float
    y: float
    width: float
    height: float
    lines: tuple[str, ...]
    bold: int

    @property
    def middle(self) -> float:
        """Vertical position of the middle [pt]."""
        return self.y + 0.5 * self.height


@dataclass(frozen=True)
class PlacedPanel:
    """A panel with its boxes by key, the headings with their x [pt], and its size [pt]."""

    panel: NetworkPanel
    boxes: Mapping[str, PlacedBox]
    headings: tuple[tuple[str, float], ...]
    width: float
    height: float


def place_panel(panel: NetworkPanel) -> PlacedPanel:
    """Return the panel with positions.

    The behaviours (the column with most links) keep the order of the document; every other column is ordered and placed
    by the mean height of the boxes to which its boxes are linked.
    """
    sized = {box.key: _sized(box) for column in panel.columns for box in column}
    tall = max(_height([sized[box.key] for box in column]) for column in panel.columns)
    behaviours = (BoxKind.BEHAVIOUR, BoxKind.COORDINATOR)
    main = next(i for i, column in enumerate(panel.columns) if column[0].kind in behaviours)
    placed: dict[str, PlacedBox] = {}
    lefts, headings = _lefts(panel, sized)
    for i in sorted(range(len(panel.columns)), key=lambda i: (abs(i - main), i)):
        boxes = [sized[box.key] for box in panel.columns[i]]
        if i == main:
            heights = _spread(boxes, tall)
        else:
            wishes = _wishes(panel, boxes, placed)
            order = sorted(range(len(boxes)), key=lambda k: wishes[k])
            boxes, wanted = [boxes[k] for k in order], [wishes[k] for k in order]
            heights = _settled(boxes, wanted, tall)
        for box, y in zip(boxes, heights, strict=True):
            placed[box.box.key] = PlacedBox(
                box.box, lefts[i], HEADING + y, _widest(panel.columns[i], sized), box.height, box.lines, box.bold
            )
    right = max(box.x + box.width for box in placed.values())
    return PlacedPanel(panel, placed, headings, right + BORDER, HEADING + tall + BORDER)


@cache
def text_width(text: str, bold: bool = False) -> float:
    """Return the width of a line of text [pt]."""
    font = FontProperties(family=FONT, weight="bold" if bold else "normal")
    if not text.strip():  # Matplotlib cannot measure empty text
        return 0.0
    plain = text.replace("$", r"\$")  # not the beginning of a formula
    return SCREEN_ROUNDING * float(TextPath((0.0, 0.0), plain, size=FONT_SIZE, prop=font).get_extents().x1)


def _sized(box: DiagramBox) -> PlacedBox:
    broken = [wrap(line, LETTERS, subsequent_indent="  ") or [""] for line in box.lines]
    lines = tuple(part for line in broken for part in line)
    bold = 0 if box.kind in NAMELESS else len(broken[0])
    width = max(text_width(line, i < bold) for i, line in enumerate(lines)) + 2.0 * PADDING
    return PlacedBox(box, 0.0, 0.0, width, len(lines) * LINE + PADDING, lines, bold)


def _widest(column: Sequence[DiagramBox], sized: Mapping[str, PlacedBox]) -> float:
    return max(*(sized[box.key].width for box in column), 0.0)


def _lefts(panel: NetworkPanel, sized: Mapping[str, PlacedBox]) -> tuple[list[float], tuple[tuple[str, float], ...]]:
    """Return the left edge of each column, and the headings with their x."""
    lefts, headings, x = [], [], BORDER
    for column in panel.columns:
        kinds = sorted({box.kind for box in column}, key=list(BoxKind).index)
        heading = " and ".join(kind.value for kind in kinds)
        lefts.append(x)
        headings.append((heading, x))
        x += max(_widest(column, sized), text_width(heading, bold=True)) + GAP
    return lefts, tuple(headings)


def _height(boxes: Sequence[PlacedBox]) -> float:
    return sum(box.height for box in boxes) + BETWEEN * (len(boxes) - 1)


def _spread(boxes: Sequence[PlacedBox], tall: float) -> list[float]:
    """Return the heights of boxes that fill `tall` evenly."""
    spare = (tall - _height(boxes)) / len(boxes)
    heights, y = [], 0.5 * spare
    for box in boxes:
        heights.append(y)
        y += box.height + BETWEEN + spare
    return heights


def _wishes(panel: NetworkPanel, boxes: Sequence[PlacedBox], placed: Mapping[str, PlacedBox]) -> list[float]:
    """Return the wanted middle of each box: the mean of the boxes to which it is linked; without links, infinity."""
    ends: dict[str, list[float]] = {box.box.key: [] for box in boxes}
    for link in panel.links:
        for key, other in ((link.start, link.end), (link.end, link.start)):
            if key in ends and other in placed:
                ends[key].append(placed[other].middle - HEADING)
    return [sum(middles) / len(middles) if middles else float("inf") for middles in ends.values()]


def _settled(boxes: Sequence[PlacedBox], wanted: Sequence[float], tall: float) -> list[float]:
    """Return positions in the given order, near the wanted ones, without overlap and within `tall`."""
    heights: list[float] = []
    lowest = 0.0
    for box, middle in zip(boxes, wanted, strict=True):
        heights.append(max(lowest, min(middle, tall) - 0.5 * box.height))
        lowest = heights[-1] + box.height + BETWEEN
    highest = tall
    for k in reversed(range(len(boxes))):
        heights[k] = min(heights[k], highest - boxes[k].height)
        highest = heights[k] - BETWEEN
    return heights


def port_heights(placed: PlacedPanel, side: Callable[[str, str], tuple[str, str]]) -> dict[tuple[str, str], float]:
    """Return for each link (start, end) the height [pt] at which it touches one of its boxes.

    `side` returns, for the keys of a link, the key of the box that it touches and the key of the other box. Links touch
    a box in the order of their other ends, so that they do not cross there.
    """
    meeting: dict[str, list[tuple[float, tuple[str, str]]]] = {}
    for link in placed.panel.links:
        here, there = side(link.start, link.end)
        meeting.setdefault(here, []).append((placed.boxes[there].middle, (link.start, link.end)))
    heights = {}
    for key, links in meeting.items():
        box = placed.boxes[key]
        step = min(7.0, (box.height - 6.0) / len(links))
        for k, (_, link_key) in enumerate(sorted(links)):
            heights[link_key] = box.middle + step * (k - 0.5 * (len(links) - 1))
    return heights
