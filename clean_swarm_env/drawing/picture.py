"""Pictures of a canvas, drawn by Matplotlib's renderers: as an array (Agg), or as a file of SVG, PNG or WebP.

What lies on a seam of the torus is drawn on both sides. Shapes: H lines and W columns of pixels, K places. Coordinates
are pixels to the right and up, unless they are in metres.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from io import BytesIO, StringIO
from math import ceil, degrees
from pathlib import Path
from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.colors import to_rgb, to_rgba
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.path import Path as Outline
from matplotlib.textpath import text_to_path
from matplotlib.transforms import Affine2D, Bbox
from PIL import Image

from clean_swarm_env.drawing.canvas import NOTHING, Canvas, Pixels, appearances, trail_strength
from clean_swarm_env.drawing.look import LOOK, OPTION_COLOURS, SIGN_OF, Sign, legend
from selector.documents.writing import write_whole
from selforg.arrays import Floats

Colour = str | tuple[str, float]
"""A colour, or one with an opacity."""
FORMATS: Final = (".svg", ".png", ".webp")
SIDE: Final = 700
"""Width of a picture [pixels], unless another one is given."""
DPI: Final = 72
"""Resolution at which a point is a pixel."""
MARGIN, TITLE, ENTRY, KEY = 12, 32, 20, 6  # [pixels] around the world, above it, of a line and of a sign of the legend
LEAST_ROBOT, LEAST_STATION = 2.0, 5.0  # half of their sizes where the world is large [pixels]
HALO: Final = 2.0
"""Width of the bright line around the robots' numbers [pixels]."""
WORDS_KEPT: Final = 512
TEXT_FONT: Final = FontProperties(family="DejaVu Sans")
NO_LETTER: Final = "\N{WHITE SQUARE}"
"""Drawn in place of a letter that the font lacks."""
WHITE, NO_COLOUR = "#ffffff", "none"
OUTLINES: Final = {
    "disc": Outline.unit_circle(),
    "diamond": Outline([(-1, 0), (0, 1), (1, 0), (0, -1), (-1, 0)]),
    "front": Outline.wedge(-degrees(LOOK.front_angle), degrees(LOOK.front_angle)),
    "stroke": Outline([(-1, 0), (1, 0)]),
    "square": Outline([(-1, -1), (-1, 1), (1, 1), (1, -1), (-1, -1)]),
}
"""Shapes of signs whose half is 1."""


def pixels_of(canvas: Canvas, side: int = SIDE, *, numbers: bool = True) -> Pixels:
    """Return a picture (H, W, 3) whose world has a longer side of about `side` [pixels]; H and W are even.

    `numbers`: whether robots have their numbers, where there is room.
    """
    picture = _Picture(canvas, side, numbers)
    renderer = RendererAgg(picture.width, picture.height, DPI)
    picture.draw(renderer)
    return np.ascontiguousarray(np.asarray(renderer.buffer_rgba())[:, :, :3])


def write_picture(canvas: Canvas, output: Path, side: int, *, numbers: bool = True) -> None:
    """Write a picture as `pixels_of` makes it.

    Raises:
        DocumentError: the file cannot be written.

    """
    if output.suffix.lower() == ".svg":
        picture, text = _Picture(canvas, side, numbers), StringIO()
        with mpl.rc_context({"svg.hashsalt": "clean-swarm"}):  # the same file each time
            renderer = RendererSVG(picture.width, picture.height, text, metadata={"Date": None})
            picture.draw(renderer)
            renderer.finalize()
        write_whole(output, text.getvalue().encode())
        return
    packed = BytesIO()
    Image.fromarray(pixels_of(canvas, side, numbers=numbers)).save(packed, output.suffix.lower()[1:], lossless=True)
    write_whole(output, packed.getvalue())


class _Picture:
    """A picture of `width` and `height`, both even, as video formats want them: title, world and legend."""

    def __init__(self, canvas: Canvas, side: int, numbers: bool) -> None:
        self._canvas, self._numbers = canvas, numbers
        self._scale = (side - 2 * MARGIN) / max(canvas.width, canvas.height)
        self._across, self._up = (max(round(length * self._scale), 1) for length in (canvas.width, canvas.height))
        self.width = max(_even(self._across + 2 * MARGIN), _even(side / 2))
        walled, zoned = len(canvas.walls) > 0, len(canvas.zones) > 0
        self._entries = legend(canvas.options, [one.sign for one in canvas.signs], canvas.model_names, walled, zoned)
        self._column = max(_length(sign.word) for sign in self._entries) + 5 * KEY
        self._columns = max(int((self.width - 2 * MARGIN) // self._column), 1)
        self.height = _even(TITLE + self._up + ceil(len(self._entries) / self._columns) * ENTRY + MARGIN)
        self._left, self._bottom = (self.width - self._across) // 2, self.height - TITLE - self._up

    def draw(self, renderer: RendererBase) -> None:
        """Draw everything."""
        self._renderer, self._pen = renderer, renderer.new_gc()
        across, up = self._across / 2, self._up / 2
        self._shape("square", self.width / 2, self.height / 2, max(self.width, self.height), WHITE)
        self._pen.set_clip_rectangle(Bbox.from_bounds(self._left, self._bottom, self._across, self._up))
        renderer.draw_image(self._pen, self._left, self._bottom, _trail(self._canvas, self._across, self._up))
        self._draw_things()
        walls = Affine2D.from_values(self._scale, 0.0, 0.0, self._scale, self._left, self._bottom)
        for wall in self._canvas.walls:
            self._outline(Outline(wall.reshape(2, 2)), walls, NO_COLOUR, LOOK.wall.colour, LOOK.wall_width)
        self._draw_robots()
        self._pen.set_clip_rectangle(None)
        middle = Affine2D.from_values(across, 0.0, 0.0, up, self._left + across, self._bottom + up)
        self._outline(OUTLINES["square"], middle, NO_COLOUR, LOOK.edge)
        time, high = f"{self._canvas.time:.1f} s", self.height - TITLE / 2 - 4.0
        self._write(time, MARGIN, high)
        after = MARGIN + _length(time) + KEY
        state = _fitting(self._canvas.state, self.width - MARGIN - after)
        self._write(state, after, high)  # apart: it seldom changes, and is kept
        for k, sign in enumerate(self._entries):
            line, column = divmod(k, self._columns)
            x, y = MARGIN + KEY + 2 + column * self._column, self._bottom - MARGIN / 2 - (line + 0.5) * ENTRY
            self._sign(sign, x, y, KEY * sign.half / LOOK.item.half if sign.shape == "diamond" else KEY)
            self._write(sign.word, x + 2 * KEY, y - 4.0)
        self._pen.restore()

    def _draw_things(self) -> None:
        """Draw zones, areas and things."""
        canvas = self._canvas
        for name, left, bottom, right, top in canvas.zones:
            x, y = 0.5 * (left + right) * self._scale + self._left, 0.5 * (bottom + top) * self._scale + self._bottom
            wide, high = 0.5 * (right - left) * self._scale, 0.5 * (top - bottom) * self._scale
            place = Affine2D.from_values(wide, 0.0, 0.0, high, x, y)
            self._outline(OUTLINES["square"], place, (LOOK.zone.colour, LOOK.zone.opacity), LOOK.zone.colour)
            self._write(name, x - wide + KEY, y - high + KEY)
        for name, x, y, radius, repels in canvas.areas:
            for _, right, up in self._places(np.array([[x, y]]), radius):
                self._area(right, up, radius, LOOK.areas[repels].colour)
                self._write(name, right, up, centred=True)
        for name, places, radius in canvas.signs:
            sign = SIGN_OF[name]
            for _, x, y in self._places(places, max(radius, sign.half)):
                if radius > 0.0:
                    self._area(x, y, radius, sign.colour)
                self._sign(sign, x, y, max(sign.half * self._scale, LEAST_STATION if sign.letter else 0.0))

    def _draw_robots(self) -> None:
        """Draw robots with fronts and cargo, and then their numbers, which nothing hides."""
        canvas = self._canvas
        radii = np.broadcast_to(canvas.radius, len(canvas.positions))
        shown = list(self._places(canvas.positions, float(radii.max(initial=0.0))))
        sizes = np.maximum(radii * self._scale, LEAST_ROBOT)
        ahead = (sizes[:, None] * np.stack([np.cos(canvas.headings), np.sin(canvas.headings)], axis=1)).tolist()
        for row, x, y in shown:
            (right, up), size = ahead[row], float(sizes[row])
            self._shape("disc", x, y, size, self._colour(row), LOOK.paper)
            front = LOOK.front_length * right, LOOK.front_length * up
            self._outline(OUTLINES["front"], Affine2D.from_values(front[0], front[1], -front[1], front[0], x, y), WHITE)
            if canvas.models is not None and (mark := LOOK.marks[canvas.models[row] % len(LOOK.marks)]):
                self._shape(mark, x, y, LOOK.mark_half * size, WHITE)
            if canvas.load is not None and canvas.load[row] != NOTHING:
                sign = SIGN_OF[canvas.loads[canvas.load[row]]]
                half = LOOK.cargo_half * size * sign.half / LOOK.item.half
                self._sign(sign, x - LOOK.cargo_behind * right, y - LOOK.cargo_behind * up, half)
        large = sizes.min(initial=np.inf) > LOOK.least_numbered
        if self._numbers and large and len(canvas.positions) <= LOOK.most_numbered:
            numbers = range(len(canvas.positions)) if canvas.numbers is None else canvas.numbers
            for row, x, y in shown:
                corner = Affine2D().translate(x + float(sizes[row]) + 1.0, y + float(sizes[row]))
                number = _word(str(numbers[row]))
                self._outline(number, corner, LOOK.paper, LOOK.paper, HALO)
                self._outline(number, corner, LOOK.ink)

    def _colour(self, row: int) -> str:
        """Return the colour of a robot."""
        if self._canvas.working is not None and not self._canvas.working[row]:
            return LOOK.failed.colour
        return OPTION_COLOURS[0 if self._canvas.held is None else self._canvas.held[row] % len(OPTION_COLOURS)]

    def _places(self, places: Floats, extent: float) -> Iterator[tuple[int, float, float]]:
        """Yield which of the things at places (K, 2) [m] show, and where."""
        rows, shown = appearances(self._canvas, places, extent)
        x, y = shown.T * self._scale
        return zip(rows.tolist(), (x + self._left).tolist(), (y + self._bottom).tolist(), strict=True)

    def _area(self, x: float, y: float, radius: float, colour: str) -> None:
        """Draw a place of a radius [m]."""
        self._shape("disc", x, y, radius * self._scale, (colour, LOOK.areas[0].opacity))
        self._shape("disc", x, y, radius * self._scale, NO_COLOUR, colour)

    def _sign(self, sign: Sign, x: float, y: float, half: float) -> None:
        if sign.shape == "stroke":
            place = Affine2D.from_values(half, 0.0, 0.0, half, x, y)
            self._outline(OUTLINES["stroke"], place, NO_COLOUR, sign.colour, LOOK.wall_width)
        else:
            edge = LOOK.ink if sign.shape == "diamond" else NO_COLOUR
            self._shape(sign.shape, x, y, half, (sign.colour, sign.opacity), edge)
        if sign.letter:
            self._outline(_word(sign.letter, 1.5 * half, centred=True), Affine2D().translate(x, y), WHITE)

    def _write(self, text: str, x: float, y: float, *, centred: bool = False) -> None:
        """Write a line of text that begins at a place, or lies around it."""
        self._outline(_word(text, centred=centred), Affine2D().translate(x, y), LOOK.ink)

    def _shape(self, shape: str, x: float, y: float, half: float, fill: Colour, edge: str = NO_COLOUR) -> None:
        self._outline(OUTLINES[shape], Affine2D.from_values(half, 0.0, 0.0, half, x, y), fill, edge)

    def _outline(
        self, outline: Outline, place: Affine2D, fill: Colour, edge: str = NO_COLOUR, width: float = 1.0
    ) -> None:
        self._pen.set_linewidth(0.0 if edge == NO_COLOUR else width)
        self._pen.set_foreground(_rgba(edge), isRGBA=True)
        self._renderer.draw_path(self._pen, outline, place, None if fill == NO_COLOUR else _rgba(fill))


_rgba = lru_cache(WORDS_KEPT)(to_rgba)


@lru_cache(WORDS_KEPT)
def _word(text: str, size: float = LOOK.letter_size, centred: bool = False) -> Outline:
    """Return the outline of a line of text, which begins at 0, 0 or lies around it."""
    known = get_font(findfont(TEXT_FONT)).get_charmap()
    drawn = "".join(letter if ord(letter) in known else NO_LETTER for letter in text)  # Matplotlib would warn
    corners, codes = text_to_path.get_text_path(TEXT_FONT, drawn)
    places = np.reshape(corners, (-1, 2)) * (size / text_to_path.FONT_SCALE)
    middle = (places.min(axis=0) + places.max(axis=0)) / 2 if centred and len(places) else 0.0
    return Outline(places - middle, codes)


@lru_cache(WORDS_KEPT)
def _length(text: str) -> float:
    """Return the length of a line of text [pixels]."""
    return float(np.max(np.asarray(_word(text).vertices)[:, 0], initial=0.0))


def _fitting(text: str, room: float) -> str:
    """Return a line of figures, such as "gaps 0.4, hits 2", of at most `room` [pixels].

    If need be, the last figures are left out, and then words before the number of the first.
    """
    while ", " in text and _length(text) > room:
        text = text.rpartition(", ")[0]
    *words, last = text.split() or [""]
    while words and _length(text) > room:
        words.pop()
        text = " ".join((*words, "...", last))
    return text


def _trail(canvas: Canvas, across: int, up: int) -> Pixels:
    """Return the pheromones (up, across, 4), the first line lowest: smooth between cells, across the seam too."""
    strength = (trail_strength(canvas) * 255.0).astype(np.uint8)
    lines, columns = strength.shape
    inside = (1, 1, columns + 1, lines + 1)
    padded = np.pad(strength, 1, mode="wrap" if canvas.closed else "edge")
    smooth = Image.fromarray(padded).resize((across, up), Image.Resampling.BILINEAR, inside)
    smooth.putpalette(trail_colours().tobytes())
    return np.array(smooth.convert("RGBA"))


@lru_cache(1)
def trail_colours() -> Pixels:
    """Return the colour (256, 3) of each strength of pheromones."""
    paper, trail = (np.array(to_rgb(colour)) for colour in (LOOK.paper, LOOK.pheromones.colour))
    shares = np.linspace(0.0, LOOK.pheromones.opacity, 256)[:, None]
    return np.asarray((255.0 * (paper + shares * (trail - paper))).round(), dtype=np.uint8)


def _even(length: float) -> int:
    return 2 * round(length / 2)
