"""Walls as straight segments without thickness, and cells by which those near a place are found (compiled).

On a torus, segments near a seam have images one world size away, so that no search has to look across seams.
"""

from collections.abc import Sequence
from functools import cache
from itertools import product
from typing import Annotated, Final, NamedTuple

import numpy as np

from selforg.arrays import READ, Floats, Ints
from selforg.compiler.decorators import inlined, part
from selforg.compiler.records import Handle, Packed, opening
from selforg.space import wrapped

NEAR: Final = 2.0
"""Distance from its cell up to which a segment is listed there, unless a longer one is asked for [m]."""
CELL_SIDE: Final = 0.5
"""Side of a cell [m], unless there were more than MOST_CELLS."""
MOST_CELLS: Final = 20_000


class Walls(NamedTuple):
    """The walls of all worlds of a batch, and cells that list the near ones; without walls there are no cells."""

    segments: Annotated[Floats, "K 4", READ]  # x, y of one end and of the other [m], images included
    first: Annotated[Ints, "CELLS", READ]  # where the list of each cell begins in `listed`; one more for its end
    listed: Annotated[Ints, "L", READ]  # numbers of segments, rising in each cell
    clear: Annotated[Floats, "CELLS", READ]  # distance [m] from the wall that every place in the cell has, or more
    left: float  # [m] lower left corner of the cells
    bottom: float  # [m]
    pitch: float  # side of a cell [m]
    near: float  # distance from its cell up to which a segment is listed there [m]
    columns: int
    lines: int


open_walls = opening(Walls)


def packed_walls(segments: Floats, low: Sequence[float], high: Sequence[float], near: float = NEAR) -> Packed[Walls]:
    """Return walls (K, 4) with cells over the rectangle from `low` to `high` [m], which list what is within `near`."""
    width, height = high[0] - low[0], high[1] - low[1]
    pitch = max(CELL_SIDE, float(np.sqrt(width * height / MOST_CELLS)))
    columns, lines = (int(np.ceil(side / pitch)) if len(segments) else 0 for side in (width, height))
    corner, beyond = np.array([low[0], low[1]]) + 0.5 * pitch, pitch * float(np.sqrt(0.5))
    places = [corner + pitch * np.array([column, line]) for line, column in product(range(lines), range(columns))]
    lists, clear = [], np.zeros(len(places))
    for cell, place in enumerate(places):  # not all distances at once, which would fill the memory
        away = distances_to(segments, place)
        lists.append(np.flatnonzero(away <= near + beyond))
        clear[cell] = away.min() - beyond
    first = np.cumsum([0, *map(len, lists)])
    listed = np.concatenate([np.zeros(0, np.int64), *lists])
    return Packed(
        Walls(
            segments=np.ascontiguousarray(segments),
            first=first,
            listed=listed,
            clear=clear,
            left=float(low[0]),
            bottom=float(low[1]),
            pitch=pitch,
            near=near,
            columns=columns,
            lines=lines,
        )
    )


@cache
def no_walls() -> Packed[Walls]:
    """Return the walls of a world without any; all such worlds share them."""
    return packed_walls(np.zeros((0, 4)), (0.0, 0.0), (1.0, 1.0))


def images(segments: Floats, extent: Floats, near: float = NEAR) -> Floats:
    """Return segments (K, 4) of a torus `extent` (2,) [m] with their images within `near` [m] of it."""
    shifts = np.array(sorted(product((-1, 0, 1), repeat=2), key=lambda shift: shift != (0, 0))) * extent
    moved = (segments + np.tile(shifts, 2)[:, None]).reshape(-1, 2, 2)
    reaches = (moved.max(axis=1) >= -near) & (moved.min(axis=1) <= extent + near)
    near_ones: Floats = moved.reshape(-1, 4)[reaches.all(axis=1)]
    return near_ones


def distances_to(segments: Floats, point: Floats) -> Floats:
    """Return the distances (K,) [m] of a point (2,) from segments (K, 4)."""
    start, way = segments[:, :2], segments[:, 2:] - segments[:, :2]
    square = (way * way).sum(axis=1)
    share = ((point - start) * way).sum(axis=1) / np.where(square > 0.0, square, 1.0)
    apart = start + np.clip(share, 0.0, 1.0)[:, None] * way - point
    distances: Floats = np.sqrt((apart * apart).sum(axis=1))
    return distances


@inlined
def cell_of_walls(x: float, y: float, w: Walls) -> int:
    """Return the cell of a place [m], -1 outside of the cells."""
    column, line = int(np.floor((x - w.left) / w.pitch)), int(np.floor((y - w.bottom) / w.pitch))
    return line * w.columns + column if 0 <= column < w.columns and 0 <= line < w.lines else -1


@inlined
def to_segment(x: float, y: float, segment: int, w: Walls) -> tuple[float, float]:
    """Return the way [m] from a place to the nearest point of a segment."""
    ax, ay = w.segments[segment, 0], w.segments[segment, 1]
    return to_line(x, y, ax, ay, w.segments[segment, 2] - ax, w.segments[segment, 3] - ay)


@inlined
def to_line(x: float, y: float, ax: float, ay: float, wx: float, wy: float) -> tuple[float, float]:
    """Return the way from (x, y) to the nearest point of the line from (ax, ay) along (wx, wy)."""
    share = min(max(((x - ax) * wx + (y - ay) * wy) / (wx * wx + wy * wy), 0.0), 1.0)
    return ax + share * wx - x, ay + share * wy - y


@part
def touches_wall(x: float, y: float, radius: float, walls: Handle[Walls]) -> bool:
    """Return whether a disc of `radius` [m] at a place touches a wall."""
    w = open_walls(walls)
    cell = cell_of_walls(x, y, w)
    if cell < 0 or w.clear[cell] >= radius:
        return False
    for k in range(w.first[cell], w.first[cell + 1]):
        dx, dy = to_segment(x, y, w.listed[k], w)
        if dx * dx + dy * dy < radius * radius:
            return True
    return False


@part
def is_hidden(x: float, y: float, dx: float, dy: float, extent: Floats, walls: Handle[Walls]) -> bool:
    """Return whether a wall lies between the place (x, y) and the one at the offset (dx, dy) [m] from it.

    extent: (2,) or more, of the space [m], 0 for an open axis.
    """
    return hides(x, y, dx, dy, extent, open_walls(walls))


@inlined
def hides(x: float, y: float, dx: float, dy: float, extent: Floats, w: Walls) -> bool:
    """Return what `is_hidden` returns, of walls that are open."""
    cell, square = cell_of_walls(x, y, w), dx * dx + dy * dy
    if cell < 0 or square > w.near * w.near:
        length = np.sqrt(square)
        return bool(length > 0.0 and wall_along(x, y, dx / length, dy / length, length, extent, w) < length)
    hidden = False
    for k in range(w.first[cell], w.first[cell + 1]):
        hidden = hidden or crosses(x, y, dx, dy, w.listed[k], w)
    return hidden


@part
def wall_along(x: float, y: float, ux: float, uy: float, length: float, extent: Floats, w: Walls) -> float:
    """Return the way [m] from a place along a unit vector to the first wall; `length` [m] if there is none so near.

    It goes from cell to cell, each of which lists all walls that are as near as the next one.
    """
    gone = 0.0
    while gone < length:
        px, py = wrapped(x + gone * ux, extent[0]), wrapped(y + gone * uy, extent[1])
        cell = cell_of_walls(px, py, w)
        first, last = (w.first[cell], w.first[cell + 1]) if cell >= 0 else (0, w.segments.shape[0])
        best = length - gone
        for k in range(first, last):
            best = min(best, way_to(px, py, ux, uy, w.listed[k] if cell >= 0 else k, w))
        if cell < 0 or best <= w.near:
            return min(gone + best, length)
        gone += max(w.near, w.clear[cell])
    return length


@inlined
def way_to(x: float, y: float, ux: float, uy: float, segment: int, w: Walls) -> float:
    """Return the way [m] from a place along a unit vector to a segment; infinity if it misses it or runs along it."""
    ax, ay = w.segments[segment, 0] - x, w.segments[segment, 1] - y
    sx, sy = w.segments[segment, 2] - w.segments[segment, 0], w.segments[segment, 3] - w.segments[segment, 1]
    across = ux * sy - uy * sx
    if across == 0.0:
        return np.inf
    way, share = (ax * sy - ay * sx) / across, (ax * uy - ay * ux) / across
    return way if way >= 0.0 and 0.0 <= share <= 1.0 else np.inf


@inlined
def crosses(x: float, y: float, dx: float, dy: float, segment: int, w: Walls) -> bool:
    """Return whether the line from (x, y) along (dx, dy) crosses a segment [m]."""
    ax, ay = w.segments[segment, 0] - x, w.segments[segment, 1] - y
    bx, by = w.segments[segment, 2] - x, w.segments[segment, 3] - y
    sx, sy = bx - ax, by - ay
    one, other = dx * ay - dy * ax, dx * by - dy * bx  # on which side of the line the ends lie
    own, there = ay * sx - ax * sy, (ay - dy) * sx - (ax - dx) * sy
    return bool(one * other <= 0.0 and own * there <= 0.0 and (one != 0.0 or other != 0.0))
