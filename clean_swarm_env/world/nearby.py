"""Points of one world in cells, so that what is near is found without looking at the rest (compiled).

For worlds with many points only: in small ones looking at all of them is cheaper. Cells are at least as wide as the
range that is asked for, so that everything in range lies in the same or in an adjacent cell.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.physics.motion import wrapped
from selforg.compiler.decorators import inlined, kernel
from selforg.space import nearest_image

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

FEW: Final = 40  # points of a world up to which all are looked at
NOBODY: Final = -1  # end of a cell's list


@kernel
def cells_along(points: int, reach: float, extent: Floats) -> tuple[int, int]:
    """Return lines and columns of cells at least `reach` [m] wide, about one a point; (0, 0) if cells do not pay."""
    side = int(np.ceil(np.sqrt(points)))
    lines, columns = min(int(extent[1] // reach), side), min(int(extent[0] // reach), side)
    return (0, 0) if points <= FEW or lines < 3 or columns < 3 else (lines, columns)


@inlined
def cell_at(place: float, cells: int, size: float) -> int:
    """Return the cell [0, cells) of a coordinate [m] on a circle of `size` [m]."""
    return min(int(wrapped(place, size) * (cells / size)), cells - 1)


@kernel
def fill_cells(positions: Floats, first: int, there: Flags, extent: Floats, cells: Ints, links: Ints) -> None:
    """Put the points that are `there` (M,) into `cells` (lines, columns); point m lies at positions[first + m] [m].

    cells gets the first point of each cell, links (M,) the next one in the same cell; lists rise.
    """
    lines, columns = cells.shape
    if lines == 0:
        return
    cells[:] = NOBODY
    for point in range(there.shape[0] - 1, -1, -1):
        if not there[point]:
            continue
        line = cell_at(positions[first + point, 1], lines, extent[1])
        column = cell_at(positions[first + point, 0], columns, extent[0])
        links[point] = cells[line, column]
        cells[line, column] = point


@inlined
def nearest_point(
    x: float, y: float, but: int, reach: float, positions: Floats, first: int, there: Flags, extent: Floats,
    cells: Ints, links: Ints,
) -> tuple[int, int, float]:  # fmt: skip
    """Return how many points other than `but` lie within `reach` [m] of a place, the nearest one and its distance [m].

    Of several equally near the first one; (0, -1, inf) where none is in reach. Without cells all points are looked at.
    """
    lines, columns = cells.shape
    line, column, walks = 0, 0, 1
    if lines > 0:
        line, column, walks = cell_at(y, lines, extent[1]), cell_at(x, columns, extent[0]), 9
    count, best, shortest = 0, NOBODY, np.inf
    for walk in range(walks):
        point = 0
        if lines > 0:
            point = cells[(line + walk // 3 - 1) % lines, (column + walk % 3 - 1) % columns]
        while point != NOBODY:
            if point != but and there[point]:
                dx = nearest_image(positions[first + point, 0] - x, extent[0])
                dy = nearest_image(positions[first + point, 1] - y, extent[1])
                length = np.sqrt(dx * dx + dy * dy)
                if length <= reach:
                    count += 1
                    if length < shortest or (length == shortest and point < best):
                        best, shortest = point, length
            point = links[point] if lines > 0 else (point + 1 if point + 1 < there.shape[0] else NOBODY)
    return count, best, shortest
