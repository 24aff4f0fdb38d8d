"""Pictures as pixels: compiled code lays discs and convex polygons, each pixel by the share of it that they cover.

Shapes: H lines and W columns of pixels, K shapes.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from clean_swarm_env.drawing.canvas import PAPER, Canvas
from clean_swarm_env.drawing.layout import SIDE, Caption, Disc, Layout, Polygon, Shape, layout_of
from selforg.arrays import Floats
from selforg.compiler.decorators import kernel

Pixels = NDArray[np.uint8]
MOST_CORNERS: Final = 4
CORNERS, RADIUS, SHARE, COLOUR, COLUMNS = 2 * MOST_CORNERS, 9, 10, 11, 14
"""Columns of the table of shapes: places first, then the number of corners (0: a disc), its radius, and its look."""
TRAIL: Final = ((0.0, PAPER), (0.5, "#cfe6f5"), (1.0, "#8cc3e6"))
"""Colours of the pheromones by their strength."""
EDGE: Final = "#9a958a"
WORDS_KEPT: Final = 512


def pixels_of(canvas: Canvas, side: int = SIDE) -> Pixels:
    """Return a picture (H, W, 3) whose world has a longer side of about `side` [pixels]; H and W are even."""
    return laid_out(layout_of(canvas, side))


def laid_out(layout: Layout) -> Pixels:
    """Return the picture (H, W, 3) of a layout."""
    left, top, width, height = layout.world
    world = np.empty((height, width, 3), dtype=np.uint8)
    lay_ground(layout.trail[::-1].copy(), trail_colours(), world)
    _draw(world, layout.inside)
    world[[0, -1]] = world[:, [0, -1]] = _rgb(EDGE)
    image = np.full((layout.height, layout.width, 3), 255, dtype=np.uint8)
    image[top : top + height, left : left + width] = world
    _draw(image, layout.shapes)
    return image


def _draw(image: Pixels, shapes: Sequence[Shape]) -> None:
    """Draw shapes, and then words, which are never behind shapes."""
    table = [_row(shape) for shape in shapes if not isinstance(shape, Caption)]
    lay_shapes(np.array(table, dtype=np.float64).reshape(-1, COLUMNS), image)
    for shape in shapes:
        if isinstance(shape, Caption):
            _write(image, shape)


def _row(shape: Disc | Polygon) -> list[float]:
    """Return a line of the table of shapes."""
    if isinstance(shape, Disc):
        return [shape.x, shape.y, *[0.0] * (CORNERS - 1), shape.radius, shape.share, *_rgb(shape.colour)]
    places = [number for corner in shape.corners for number in corner]
    return [*places, *[0.0] * (CORNERS - len(places)), len(shape.corners), 0.0, 1.0, *_rgb(shape.colour)]


def _write(image: Pixels, word: Caption) -> None:
    mask = _mask(word.text, word.size)
    left = round(word.x - (mask.shape[1] / 2 if word.centred else 0))
    top = round(word.y - mask.shape[0] / 2)
    mask = mask[max(-top, 0) : image.shape[0] - top, max(-left, 0) : image.shape[1] - left, None]
    left, top = max(left, 0), max(top, 0)
    behind = image[top : top + len(mask), left : left + mask.shape[1]]
    behind[:] = behind + mask * (np.array(_rgb(word.colour)) - behind)


@lru_cache(WORDS_KEPT)
def _mask(text: str, size: float) -> Floats:
    """Return which share of each pixel a line of text covers."""
    font = ImageFont.load_default(size)
    _, above, across, down = font.getbbox(text, anchor="lm")
    half = int(max(-above, down)) + 1
    image = Image.new("L", (int(across) + 2, 2 * half))
    ImageDraw.Draw(image).text((0, half), text, 255, font, anchor="lm")
    return np.asarray(image) / 255.0


@lru_cache(1)
def trail_colours() -> Pixels:
    """Return the colour (256, 3) of each strength of pheromones."""
    at, colours = zip(*((share, _rgb(colour)) for share, colour in TRAIL), strict=True)
    strengths = np.linspace(0.0, 1.0, 256)
    each = [np.interp(strengths, at, [colour[part] for colour in colours]) for part in range(3)]
    return np.stack(each, axis=1).astype(np.uint8)


@lru_cache(WORDS_KEPT)
def _rgb(colour: str) -> tuple[int, int, int]:
    """Return red, green and blue of #rrggbb."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue


@kernel
def lay_ground(strength: Floats, colours: Pixels, image: Pixels) -> None:
    """Fill an image (H, W, 3) with the colours of a raster of a torus, in its order of lines, between its cells."""
    lines, columns = strength.shape
    height, width = image.shape[:2]
    first, second, right = np.empty(width, np.int64), np.empty(width, np.int64), np.empty(width)
    for x in range(width):
        u = (x + 0.5) * columns / width - 0.5
        first[x] = int(np.floor(u)) % columns
        second[x], right[x] = (first[x] + 1) % columns, u - np.floor(u)
    for y in range(height):
        v = (y + 0.5) * lines / height - 0.5
        upper, down = int(np.floor(v)), v - np.floor(v)
        line = (1.0 - down) * strength[upper % lines] + down * strength[(upper + 1) % lines]
        for x in range(width):
            here = line[first[x]] + right[x] * (line[second[x]] - line[first[x]])
            colour = int(255.0 * here)
            image[y, x, 0], image[y, x, 1], image[y, x, 2] = colours[colour, 0], colours[colour, 1], colours[colour, 2]


@kernel
def lay_shapes(table: Floats, image: Pixels) -> None:
    """Lay the shapes of a table (K, COLUMNS) on an image (H, W, 3), one after the other."""
    height, width = image.shape[:2]
    for k in range(len(table)):
        shape = table[k]
        count, radius = int(shape[CORNERS]), shape[RADIUS]
        low_x, high_x, low_y, high_y = shape[0] - radius, shape[0] + radius, shape[1] - radius, shape[1] + radius
        area = 0.0
        for a in range(count):
            b = (a + 1) % count
            low_x, high_x = min(low_x, shape[2 * a]), max(high_x, shape[2 * a])
            low_y, high_y = min(low_y, shape[2 * a + 1]), max(high_y, shape[2 * a + 1])
            area += shape[2 * a] * shape[2 * b + 1] - shape[2 * b] * shape[2 * a + 1]
        side = 1.0 if area > 0.0 else -1.0
        for y in range(max(int(low_y) - 1, 0), min(int(high_y) + 2, height)):
            for x in range(max(int(low_x) - 1, 0), min(int(high_x) + 2, width)):
                px, py = x + 0.5, y + 0.5
                inside = radius - np.hypot(px - shape[0], py - shape[1]) if count == 0 else np.inf
                for a in range(count):
                    b = (a + 1) % count
                    dx, dy = shape[2 * b] - shape[2 * a], shape[2 * b + 1] - shape[2 * a + 1]
                    across = dx * (py - shape[2 * a + 1]) - dy * (px - shape[2 * a])
                    inside = min(inside, side * across / max(np.hypot(dx, dy), 1e-9))
                cover = shape[SHARE] * min(max(inside + 0.5, 0.0), 1.0)
                for part in range(3):
                    behind = image[y, x, part]
                    image[y, x, part] = np.uint8(behind + cover * (shape[COLOUR + part] - behind) + 0.5)
