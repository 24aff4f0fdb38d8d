"""The layout of a picture: the shapes of a canvas in pixels, from which `pixels` and `svg` make files.

Coordinates are pixels to the right and down. The world is a picture of its own, `world`, that cuts off what lies beyond
the seam; what lies on the seam is drawn on both sides.
"""

from dataclasses import dataclass
from math import ceil, cos, sin
from typing import Final

import numpy as np

from clean_swarm_env.drawing.canvas import (
    INK,
    ITEM_COLOUR,
    LEFTOVERS,
    OPTION_COLOURS,
    PAPER,
    SEARCHING,
    STATIONS,
    Canvas,
    appearances,
    trail_strength,
)
from selforg.arrays import Floats

SIDE: Final = 700
"""Width of a picture [pixels], unless another one is given."""
LEAST_SIDE, MOST_SIDE = 200, 4000
MARGIN, TITLE, ENTRY = 12, 32, 20  # [pixels] around the world, above it, and of a line of the legend
LETTER_SIZE: Final = 13.0
LETTER: Final = 0.58
"""Mean width of a letter, in sizes of its font; the legend's columns follow from it."""
WHITE: Final = "#ffffff"
ATTRACTS: Final = "#009E73"
REPELS: Final = "#D55E00"
OUT_OF_WORK: Final = "#77736b"


@dataclass(frozen=True)
class Disc:
    """A disc: its centre, radius and colour; `share` is its opacity."""

    x: float
    y: float
    radius: float
    colour: str
    share: float = 1.0


@dataclass(frozen=True)
class Polygon:
    """A polygon: its corners and its colour."""

    corners: tuple[tuple[float, float], ...]
    colour: str


@dataclass(frozen=True)
class Caption:
    """A line of text: its middle in height, its left end (or its middle, if `centred`), and its size."""

    x: float
    y: float
    text: str
    colour: str = INK
    size: float = LETTER_SIZE
    centred: bool = False


Shape = Disc | Polygon | Caption


@dataclass(frozen=True)
class Layout:
    """A picture of `width` and `height`, both even, as video formats want them."""

    width: int
    height: int
    shapes: tuple[Shape, ...]
    """What is around the world: title and legend."""
    world: tuple[int, int, int, int]
    """Left, top, width and height of the world."""
    trail: Floats
    """Strength of the pheromones, see `trail_strength`; behind the shapes of the world."""
    inside: tuple[Shape, ...]
    """What is in the world, in coordinates of the world."""


def layout_of(canvas: Canvas, side: int = SIDE) -> Layout:
    """Return the layout of a picture whose world has a longer side of about `side` [pixels].

    >>> canvas = Canvas(np.array([[0.1, 5.0]]), np.zeros(1), stations=np.array([[2.75, 5.5], [8.25, 5.5]]))
    >>> layout_of(canvas).width
    700
    """
    scale = (side - 2 * MARGIN) / max(canvas.width, canvas.height)
    across, up = (max(round(length * scale), 1) for length in (canvas.width, canvas.height))
    width = max(_even(across + 2 * MARGIN), _even(side / 2))
    title = ", ".join(filter(None, [f"{canvas.time:.1f} s", canvas.state]))
    legend, deep = _legend(canvas, width, TITLE + up + MARGIN)
    left = (width - across) // 2
    return Layout(
        width,
        _even(deep),
        (Caption(MARGIN, TITLE / 2, title), *legend),
        (left, TITLE, across, up),
        trail_strength(canvas),
        tuple(_Drawer(canvas, scale).shapes()),
    )


class _Drawer:
    """Makes the shapes of a world."""

    def __init__(self, canvas: Canvas, scale: float) -> None:
        self._canvas, self._scale = canvas, scale

    def shapes(self) -> list[Shape]:
        canvas, robots = self._canvas, len(self._canvas.positions)
        found: list[Shape] = []
        for name, x, y, radius, repels in canvas.areas:
            for right, down in self._at(np.array([x, y]), radius):
                colour = REPELS if repels else ATTRACTS
                found += [
                    Disc(right, down, self._pixels(radius), colour, 0.3),
                    Caption(right, down, name, centred=True),
                ]
        for place, kind in zip(canvas.stations, canvas.station_kinds, strict=False):
            found += self._station(place, *STATIONS[kind])
        leftover = np.zeros(len(canvas.garbage), dtype=np.bool_) if canvas.leftover is None else canvas.leftover
        for place, small in zip(canvas.garbage, leftover.tolist(), strict=True):
            for x, y in self._at(place, 0.11):
                found += _item(x, y, self._pixels(0.07 if small else 0.11))
        cargo = [SEARCHING] * robots if canvas.cargo is None else canvas.cargo.tolist()
        working = [True] * robots if canvas.working is None else canvas.working.tolist()
        held = [0] * robots if canvas.held is None else canvas.held.tolist()
        for row in range(robots):
            colour = OPTION_COLOURS[held[row] % len(OPTION_COLOURS)] if working[row] else OUT_OF_WORK
            for x, y in self._at(canvas.positions[row], canvas.radius):
                found += self._robot(x, y, float(canvas.headings[row]), colour)
                if cargo[row] != SEARCHING:
                    small = 0.5 * self._pixels(canvas.radius) * (0.6 if cargo[row] == LEFTOVERS else 1.0)
                    found += _item(x, y, small)
        return found

    def _at(self, place: Floats, extent: float) -> list[tuple[float, float]]:
        """Return where a thing shows, in pixels."""
        canvas, scale = self._canvas, self._scale
        return [(x * scale, (canvas.height - y) * scale) for x, y in appearances(canvas, place, extent)]

    def _pixels(self, length: float) -> float:
        return length * self._scale

    def _robot(self, x: float, y: float, heading: float, colour: str) -> list[Shape]:
        """Return a disc with a white rim and a white wedge that shows ahead."""
        radius = self._pixels(self._canvas.radius)
        rim = min(1.0, 0.2 * radius)
        ahead, edges = 0.9 * radius, (heading - 0.4, heading + 0.4)
        tips = [(x + ahead * cos(angle), y - ahead * sin(angle)) for angle in edges]
        return [Disc(x, y, radius, WHITE), Disc(x, y, radius - rim, colour), Polygon(((x, y), *tips), WHITE)]

    def _station(self, place: Floats, name: str, colour: str) -> list[Shape]:
        """Return a square with a letter, and the circle in which a robot is there."""
        reach = self._pixels(self._canvas.station_radius)
        half, found = max(0.4 * reach, 4.0), list[Shape]()
        for x, y in self._at(place, self._canvas.station_radius):
            corners = ((x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half))
            found += [Disc(x, y, reach, colour, 0.25), Disc(x, y, max(reach - 1.5, 0.0), PAPER, 0.6)]
            found += [Polygon(corners, colour), Caption(x, y, name[0].upper(), WHITE, 1.4 * half, centred=True)]
        return found


def _item(x: float, y: float, half: float) -> list[Shape]:
    """Return a diamond with a dark edge of `half` its height."""
    sizes = ((half, INK), (half - min(1.2, 0.3 * half), ITEM_COLOUR))
    return [Polygon(((x - s, y), (x, y - s), (x + s, y), (x, y + s)), colour) for s, colour in sizes]


def _legend(canvas: Canvas, width: int, top: float) -> tuple[list[Shape], float]:
    """Return the legend below the world, and where the picture ends; it is the same for all moments of a run."""
    entries = [(name, OPTION_COLOURS[k % len(OPTION_COLOURS)]) for k, name in enumerate(canvas.options)]
    names = [name for name, _ in entries] + (["item", "leftovers of an item"] if len(canvas.stations) else [])
    if not names:
        return [], top
    column = (max(map(len, names)) * LETTER * LETTER_SIZE) + 30.0
    columns = max(int((width - 2 * MARGIN) // column), 1)
    shapes: list[Shape] = []
    for k, name in enumerate(names):
        x, y = MARGIN + 8.0 + k % columns * column, top + (k // columns + 0.5) * ENTRY
        shapes += [Disc(x, y, 6.0, entries[k][1])] if k < len(entries) else _item(x, y, 7.0 if name == "item" else 4.5)
        shapes.append(Caption(x + 13.0, y, name))
    return shapes, top + ceil(len(names) / columns) * ENTRY + MARGIN / 2


def _even(length: float) -> int:
    return 2 * round(length / 2)
