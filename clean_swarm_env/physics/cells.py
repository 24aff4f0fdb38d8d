"""A grid of cells over the points of one world: searches for near points look at nine cells only (compiled).

Cells save time only in worlds with many points. A cell is at least as wide as the distance that is asked for, so that
everything within that distance lies in the same cell or in one of the eight around it.
The cells of gradients are slower here: docs/decisions/0116-two-kinds-of-cells.md.
"""

from typing import Final

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import inlined, kernel, part
from selforg.space import nearest_image, wrapped

FEW: Final = 40  # points of a world up to which looking at all of them is cheaper
NOBODY: Final = -1  # marks the end of the list of a cell


@kernel
def cells_along(points: int, reach: float, extent: Floats) -> tuple[int, int]:
    """Return lines and columns of cells at least `reach` [m] wide, about one a point; (0, 0) if cells save no time."""
    side = int(np.ceil(np.sqrt(points)))
    lines, columns = min(int(extent[1] // reach), side), min(int(extent[0] // reach), side)
    return (0, 0) if points <= FEW or lines < 3 or columns < 3 else (lines, columns)


@inlined
def cell_at(place: float, cells: int, size: float) -> int:
    """Return the cell [0, cells) of a coordinate [m] on a circle of `size` [m]."""
    return min(int(wrapped(place, size) * (cells / size)), cells - 1)


@part
def fill_cells(positions: Floats, first: int, there: Flags, extent: Floats, cells: Ints, links: Ints) -> None:
    """Put the points that are `there` (M,) into `cells` (lines, columns); point m lies at positions[first + m] [m].

    `cells` gets the first point of each cell, `links` (M,) the next one in the same cell, in rising order.
    """
    lines, columns = cells.shape
    if lines == 0:
        return
    for line in range(lines):
        for column in range(columns):
            cells[line, column] = NOBODY
    for point in range(there.shape[0] - 1, -1, -1):
        if not there[point]:
            continue
        line = cell_at(positions[first + point, 1], lines, extent[1])
        column = cell_at(positions[first + point, 0], columns, extent[0])
        links[point] = cells[line, column]
        cells[line, column] = point


@inlined
def cell_beside(line: int, column: int, walk: int, cells: Ints) -> int:
    """Return the first point of the cell number `walk` of the nine in and around (line, column)."""
    lines, columns = cells.shape
    return int(cells[(line + walk // 3 - 1) % lines, (column + walk % 3 - 1) % columns])


@inlined
def nearest_point(
    x: float, y: float, reach: float, positions: Floats, there: Flags, extent: Floats, cells: Ints, links: Ints
) -> tuple[int, float]:
    """Return the nearest point that is `there` (M,) within `reach` [m] of a place, and its distance [m].

    Of several equally near points the first one counts. Returns (NOBODY, inf) where none is in reach. Without cells the
    search looks at all points.
    """
    lines, columns = cells.shape
    line, column, walks = 0, 0, 1
    if lines > 0:
        line, column, walks = cell_at(y, lines, extent[1]), cell_at(x, columns, extent[0]), 9
    best, shortest = NOBODY, np.inf
    for walk in range(walks):
        point = cell_beside(line, column, walk, cells) if lines > 0 else (0 if there.shape[0] > 0 else NOBODY)
        while point != NOBODY:
            if there[point]:
                length = distance(x, y, positions[point, 0], positions[point, 1], extent)
                if length <= reach and (length < shortest or (length == shortest and point < best)):
                    best, shortest = point, length
            point = links[point] if lines > 0 else (point + 1 if point + 1 < there.shape[0] else NOBODY)
    return best, shortest


@inlined
def distance(ax: float, ay: float, bx: float, by: float, extent: Floats) -> float:
    """Return the distance [m] of two points of the torus `extent` (2,) [m]."""
    x, y = nearest_image(bx - ax, extent[0]), nearest_image(by - ay, extent[1])
    return float(np.sqrt(x * x + y * y))


@part
def nearest_of_kind(x: float, y: float, kind: int, places: Floats, kinds: Ints, extent: Floats) -> tuple[int, float]:
    """Return which of `places` (K, 2) of a kind is nearest to (x, y), the first among equals, and how far it is.

    kinds: (K,). Lengths in [m]. Without any the answer is NOBODY.
    """
    best, shortest = NOBODY, np.inf
    for place in range(places.shape[0]):
        if kinds[place] == kind:
            away = distance(x, y, places[place, 0], places[place, 1], extent)
            if away < shortest:
                best, shortest = place, away
    return best, shortest
