"""Cells of a grid, by which points near a place are found without looking at all the others.

A table of cells, float64 (L, CELL_COLUMNS), holds one grid in each row: number and width [m] of the cells along x, y
and z. Open axes are rings of cells too: far cells that share a number are distinguished by the distance of their
contents. Cells are kept in the buckets of a hash table, whose owner tells apart the cells that share a bucket.
"""

import numpy as np

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.decorators import part

NUMBER_X, WIDTH_X, NUMBER_Y, WIDTH_Y, NUMBER_Z, WIDTH_Z = 0, 1, 2, 3, 4, 5
CELL_COLUMNS = 6

SLACK = 1e-9  # [m], covers the rounding of cell borders
MOST_CELLS = 4096  # where a window would have more cells, all points are looked at


def axis_cells(extent: float, width: float, most: float) -> tuple[float, float]:
    """Return number and width [m] of the cells of at least `width` on an axis of `extent` [m], on an open one `most`.

    The width is made larger so that a whole number of cells fits a closed axis.
    """
    if extent <= 0.0:
        return most, width
    number = min(most, max(1.0, float(np.floor(extent / width))))
    return number, extent / number


@part
def ring_cell(coordinate: float, number: float, width: float) -> int:
    """Return the cell along one axis, in [0, number)."""
    return int(np.floor(coordinate / width)) % int(number)


@part
def cell_of(x: float, y: float, z: float, cells: Floats, row: int) -> int:
    """Return the number of the cell at (x, y, z) [m] in the grid of one row of `cells` (L, CELL_COLUMNS)."""
    i = ring_cell(x, cells[row, NUMBER_X], cells[row, WIDTH_X])
    j = ring_cell(y, cells[row, NUMBER_Y], cells[row, WIDTH_Y])
    k = ring_cell(z, cells[row, NUMBER_Z], cells[row, WIDTH_Z])
    return (k * int(cells[row, NUMBER_Y]) + j) * int(cells[row, NUMBER_X]) + i


@part
def bucket_of(group: int, cell: int, buckets: Links) -> int:
    """Return the bucket of a cell of a group (a layer, a team); the number of `buckets` (B,) is a power of two.

    Sixteen neighbouring cells of a line share a cache line of buckets, so that a window reads few cache lines.
    """
    mixed = (int(cell) >> 4) * 1540483477 + int(group) * 1013904223  # both below 2**31: no overflow of 64 bits
    mixed ^= mixed >> 17
    mixed ^= mixed >> 9
    return ((mixed << 4) | (int(cell) & 15)) & (len(buckets) - 1)


@part
def near_cells(
    x: float, y: float, z: float, radius: float, cells: Floats, row: int, members: float, window: Ints
) -> int:
    """Write the cells that come within `radius` [m] of (x, y, z) into `window` (MOST_CELLS,) and return how many.

    The grid is that of one row of `cells` (L, CELL_COLUMNS). Returns -1 if looking at all `members` of the grid one by
    one is cheaper. The choice depends on no other grid, so that other grids cannot change the order of a sum.
    """
    padded = radius + SLACK
    number_i, width_i = int(cells[row, NUMBER_X]), cells[row, WIDTH_X]
    number_j, width_j = int(cells[row, NUMBER_Y]), cells[row, WIDTH_Y]
    number_k, width_k = int(cells[row, NUMBER_Z]), cells[row, WIDTH_Z]
    i0, i1, whole_i = axis_window(x, padded, number_i, width_i)
    j0, j1, whole_j = axis_window(y, padded, number_j, width_j)
    k0, k1, whole_k = axis_window(z, padded, number_k, width_k)
    number = float(i1 - i0) * float(j1 - j0) * float(k1 - k0)
    if number > len(window) or number > members:
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
                window[found] = line + column  # every cell is written, and `found` grows if it is near: no branch
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
