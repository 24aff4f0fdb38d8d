"""Linking of stored gradients: a list per layer and buckets of cells, so that near ones are found without the rest.

A cell of a layer is a bucket of a hash table; a bucket may hold several cells, told apart by LAYER and CELL. Open
axes are rings of cells too: far cells that share a number are told apart by their distance. Within a cell the newest
comes first; neither growing the table nor other spaces change that order, so the sum over a cell is reproducible.
"""

import numpy as np

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.decorators import inlined, lean_kernel, part
from selforg.gradients.store.columns import (
    AFTER,
    BEFORE,
    BOUND,
    BOUNDED,
    CELL,
    CELLS,
    CHANNELS,
    COUNT,
    DIFFUSION,
    FREE,
    GOAL,
    GRID_COLUMNS,
    HEAD,
    HIGH,
    LAYER,
    LEVELS,
    MOVING,
    NEXT,
    PER_ROW,
    RANK,
    SPACES,
    SWEEP,
    TAIL,
    TEAM,
    UNBOUNDED,
    USED,
    X,
    Y,
    Z,
)

CELL_BITS = 30  # a cell number fits 32 bits with its sign; the axes share them
SLACK = 1e-9  # [m], covers the rounding of cell borders


def make_grid(extent: Floats, dim: int, smallest: float) -> Floats:
    """Return the table of cells (LEVELS, GRID_COLUMNS) for a space of padded `extent` (3,) [m].

    Level l takes gradients up to a reach of `smallest` * 2**l [m]. Its cells are half as wide as that (measured:
    narrower ones cost more in look-ups than they save), or a little wider so that a whole number fits a closed axis.
    """
    ring = float(1 << CELL_BITS // dim)
    grid = np.zeros((LEVELS, GRID_COLUMNS))
    for level in range(BOUNDED):
        grid[level, BOUND] = smallest * 2.0**level
        for axis in range(3):
            width, number = 0.5 * grid[level, BOUND], ring
            if axis >= dim:
                width, number = np.inf, 1.0
            elif extent[axis] > 0.0:
                number = min(ring, max(1.0, np.floor(extent[axis] / width)))
                width = extent[axis] / number
            grid[level, CELLS + 2 * axis : CELLS + 2 * axis + 2] = number, width
    grid[BOUNDED:, BOUND] = np.inf
    return grid


@inlined
def whole(number: int) -> int:
    """Return a number of the int32 tables as Numba's usual integer, so that what takes it is compiled once only."""
    return int(number) + 0


@part
def level_of(reach: float, grid: Floats) -> int:
    """Return the lowest level whose bound holds `reach` [m]."""
    for level in range(BOUNDED):
        if reach <= grid[level, BOUND]:
            return level
    return UNBOUNDED


@part
def layer_of(channel: int, space: int, level: int, counters: Ints) -> int:
    """Return the row of the layer table; channels are its slowest axis, so that new channels append rows."""
    return (channel * int(counters[SPACES]) + space) * LEVELS + level


@part
def space_of(row: int, rows: Ints, counters: Ints) -> int:
    """Return the information space that `row` reads: its own, or its team's under ideal delivery."""
    return row if counters[PER_ROW] else int(rows[row, TEAM])


@part
def cell_of(x: float, y: float, z: float, grid: Floats, level: int) -> int:
    """Return the number of the cell at (x, y, z) [m] in one level of the grid (levels, GRID_COLUMNS)."""
    i = ring_cell(x, grid[level, CELLS], grid[level, CELLS + 1])
    j = ring_cell(y, grid[level, CELLS + 2], grid[level, CELLS + 3])
    k = ring_cell(z, grid[level, CELLS + 4], grid[level, CELLS + 5])
    return (k * int(grid[level, CELLS + 2]) + j) * int(grid[level, CELLS]) + i


@part
def ring_cell(coordinate: float, number: float, width: float) -> int:
    """Return the cell along one axis, in [0, number)."""
    return int(np.floor(coordinate / width)) % int(number)


@part
def bucket_of(layer: int, cell: int, buckets: Links) -> int:
    """Return the bucket of a cell; the number of buckets is a power of two.

    Sixteen neighbouring cells of a line share a cache line of buckets: a window then waits for few of them.
    """
    mixed = (cell >> 4) * 1540483477 + layer * 1013904223  # both below 2**31: no overflow of 64 bits
    mixed ^= mixed >> 17
    mixed ^= mixed >> 9
    return ((mixed << 4) | (cell & 15)) & (len(buckets) - 1)


@part
def link(slot: int, links: Links, marks: Links, layers: Links, buckets: Links) -> None:
    """Put `slot`, whose LAYER and CELL are set, at the front of its bucket and at the end of its layer's list."""
    layer = whole(links[slot, LAYER])
    bucket = bucket_of(layer, whole(links[slot, CELL]), buckets)
    links[slot, NEXT] = buckets[bucket]
    buckets[bucket] = slot
    tail = layers[layer, TAIL]
    marks[slot, BEFORE] = tail
    marks[slot, AFTER] = -1
    if tail >= 0:
        marks[tail, AFTER] = slot
    else:
        layers[layer, HEAD] = slot
    layers[layer, TAIL] = slot
    layers[layer, COUNT] += 1


@part
def unlink(slot: int, links: Links, marks: Links, layers: Links, buckets: Links) -> None:
    """Take `slot` out of its bucket and its layer's list."""
    layer = whole(links[slot, LAYER])
    bucket = bucket_of(layer, whole(links[slot, CELL]), buckets)
    after, before = marks[slot, AFTER], marks[slot, BEFORE]
    if buckets[bucket] == slot:
        buckets[bucket] = links[slot, NEXT]
    else:
        previous = buckets[bucket]
        while links[previous, NEXT] != slot:
            previous = links[previous, NEXT]
        links[previous, NEXT] = links[slot, NEXT]
    if before >= 0:
        marks[before, AFTER] = after
    else:
        layers[layer, HEAD] = after
    if after >= 0:
        marks[after, BEFORE] = before
    else:
        layers[layer, TAIL] = before
    if layers[layer, SWEEP] == slot:
        layers[layer, SWEEP] = after
    layers[layer, COUNT] -= 1


@part
def take_slot(links: Links, counters: Ints) -> int:
    """Return a free slot; the caller has made sure that there is one."""
    slot = int(counters[FREE])
    if slot >= 0:
        counters[FREE] = links[slot, NEXT]
    else:
        slot = int(counters[HIGH])
        counters[HIGH] += 1
    counters[USED] += 1
    return slot


@part
def remove(slot: int, links: Links, marks: Links, layers: Links, buckets: Links, counters: Ints) -> None:
    """Delete the gradient in `slot`; older moving gradients of its source move up one rank."""
    layer = whole(links[slot, LAYER])
    unlink(slot, links, marks, layers, buckets)
    if layer % LEVELS == MOVING:
        cell, rank = links[slot, CELL], marks[slot, RANK]
        other = whole(buckets[bucket_of(layer, whole(cell), buckets)])
        while other >= 0:
            if links[other, LAYER] == layer and links[other, CELL] == cell and marks[other, RANK] > rank:
                marks[other, RANK] -= 1
            other = whole(links[other, NEXT])
    links[slot, LAYER] = -1
    links[slot, NEXT] = counters[FREE]
    counters[FREE] = slot
    counters[USED] -= 1


@part
def insert(
    slot: int, layer: int, near: Floats, links: Links, marks: Links, layers: Links, buckets: Links, grid: Floats
) -> None:
    """Link the static gradient whose fields are in `slot` into `layer`, by its position."""
    links[slot, LAYER] = layer
    level = layer % LEVELS
    links[slot, CELL] = 0
    if level < BOUNDED:
        links[slot, CELL] = cell_of(near[slot, X], near[slot, Y], near[slot, Z], grid, level)
    marks[slot, RANK] = 0
    link(slot, links, marks, layers, buckets)


@part
def level_for(slot: int, near: Floats, grid: Floats) -> int:
    """Return the level of the static gradient in `slot` by its reach."""
    return level_of(near[slot, DIFFUSION] + near[slot, GOAL], grid)


@lean_kernel
def rebuild(links: Links, marks: Links, layers: Links, buckets: Links, counters: Ints) -> None:
    """Fill empty `buckets` anew from the lists of the layers: in their order, so that each cell keeps its own."""
    buckets[:] = -1
    for layer in range(int(counters[SPACES] * counters[CHANNELS]) * LEVELS):
        slot = whole(layers[layer, HEAD])
        while slot >= 0:
            bucket = bucket_of(layer, whole(links[slot, CELL]), buckets)
            links[slot, NEXT] = buckets[bucket]
            buckets[bucket] = slot
            slot = whole(marks[slot, AFTER])
