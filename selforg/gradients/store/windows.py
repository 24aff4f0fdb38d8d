"""The cells within a distance of a point."""

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import part
from selforg.gradients.store.columns import CELLS
from selforg.gradients.store.grid import SLACK

MOST_CELLS = 4096  # a window of more cells is not walked; the whole list is


@part
def near_cells(
    x: float, y: float, z: float, radius: float, grid: Floats, level: int, members: float, cells: Ints
) -> int:
    """Write the cells that come within `radius` [m] of (x, y, z) into `cells` and return how many.

    grid: (levels, GRID_COLUMNS). Returns -1 where looking at all `members` of the layer one by one is cheaper. That
    choice rests on the own layer only, so that other spaces cannot change the order of a sum.
    """
    padded = radius + SLACK
    number_i, width_i = int(grid[level, CELLS]), grid[level, CELLS + 1]
    number_j, width_j = int(grid[level, CELLS + 2]), grid[level, CELLS + 3]
    number_k, width_k = int(grid[level, CELLS + 4]), grid[level, CELLS + 5]
    i0, i1, whole_i = axis_window(x, padded, number_i, width_i)
    j0, j1, whole_j = axis_window(y, padded, number_j, width_j)
    k0, k1, whole_k = axis_window(z, padded, number_k, width_k)
    window = float(i1 - i0) * float(j1 - j0) * float(k1 - k0)
    if window > len(cells) or window > members:
        return -1
    found = 0
    for k in range(k0, k1):
        gap_k = 0.0 if whole_k else axis_gap(z, k, width_k)
        for j in range(j0, j1):
            gap_j = gap_k if whole_j else gap_k + axis_gap(y, j, width_j)
            line = ((k % number_k) * number_j + j % number_j) * number_i
            column = i0 % number_i
            for i in range(i0, i1):
                gap = gap_j if whole_i else gap_j + axis_gap(x, i, width_i)
                cells[found] = line + column  # written where the next one goes, and kept if it is near
                found += 1 if gap <= padded * padded else 0
                column = column + 1 if column + 1 < number_i else 0
    return found


@part
def axis_window(coordinate: float, radius: float, number: int, width: float) -> tuple[int, int, bool]:
    """Return the cells within `radius` [m] on one axis as a half-open range, and whether it is all of them."""
    if 2.0 * radius >= (number - 2.0) * width:
        return 0, number, True
    first = int(np.floor((coordinate - radius) / width))
    last = int(np.floor((coordinate + radius) / width))
    return first, last + 1, False


@part
def axis_gap(coordinate: float, cell: int, width: float) -> float:
    """Return the squared distance [m2] from `coordinate` to the (unwrapped) cell along one axis."""
    gap = max(cell * width - coordinate, coordinate - (cell + 1) * width, 0.0)
    return gap * gap
