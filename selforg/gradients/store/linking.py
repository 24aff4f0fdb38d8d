"""Linking of stored gradients: a list per layer, and buckets of cells by which near gradients are found.

A bucket may have several cells, distinguished by LINK_LAYER and LINK_CELL. Within a cell the newest comes first;
neither growing the tables nor other spaces change that order, so the sum over a cell is reproducible.
"""

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel, part
from selforg.compiler.records import Handle, Written
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Store, open_store
from selforg.grid import CELL_COLUMNS, axis_cells, bucket_of, cell_of

CELL_BITS = 30  # a cell number fits 32 bits with its sign; the axes share them


def make_levels(extent: Floats, dim: int, smallest: float) -> tuple[Floats, Floats]:
    """Return bound (LEVELS,) [m] and cells (LEVELS, CELL_COLUMNS) of each level, for a space of `extent` (3,) [m].

    Level l takes gradients up to a reach of `smallest` * 2**l [m]. Its cells are half as wide as that: narrower ones
    were measured to cost more in look-ups than they save.
    """
    ring = float(1 << CELL_BITS // dim)
    bounds, cells = np.full(c.LEVELS, np.inf), np.zeros((c.LEVELS, CELL_COLUMNS))
    for level in range(c.BOUNDED):
        bounds[level] = smallest * 2.0**level
        for axis in range(3):
            one = axis_cells(extent[axis], 0.5 * bounds[level], ring) if axis < dim else (1.0, np.inf)
            cells[level, 2 * axis : 2 * axis + 2] = one
    return bounds, cells


@part
def level_for(slot: int, store: Handle[Store]) -> int:
    """Return the lowest level whose bound holds the reach of the static gradient in `slot`."""
    s = open_store(store)
    reach = s.near[slot, c.DIFFUSION] + s.near[slot, c.GOAL_RADIUS]
    for level in range(c.BOUNDED):
        if reach <= s.bounds[level]:
            return level
    return c.UNBOUNDED


@part
def first_layer(channel: int, space: int, store: Handle[Store]) -> int:
    """Return the layer of level 0; channels are the slowest axis of layers, so that new channels append rows."""
    return (channel * open_store(store).spaces + space) * c.LEVELS


@part
def space_of(row: int, teams: Ints, store: Handle[Store]) -> int:
    """Return the information space that `row` reads: its own, or its team's under ideal delivery."""
    return row if open_store(store).per_row else int(teams[row])


@part
def link(slot: int, store: Written[Store]) -> None:
    """Put `slot`, whose layer and cell are set, at the front of its bucket and at the end of its layer's list."""
    s = open_store(store)
    layer = s.links[slot, c.LINK_LAYER]
    bucket = bucket_of(layer, s.links[slot, c.LINK_CELL], s.buckets)
    s.links[slot, c.LINK_NEXT] = s.buckets[bucket]
    s.buckets[bucket] = slot
    tail = s.layers[layer, c.LAYER_TAIL]
    s.marks[slot, c.MARK_BEFORE] = tail
    s.marks[slot, c.MARK_AFTER] = -1
    if tail >= 0:
        s.marks[tail, c.MARK_AFTER] = slot
    else:
        s.layers[layer, c.LAYER_HEAD] = slot
    s.layers[layer, c.LAYER_TAIL] = slot
    s.layers[layer, c.LAYER_COUNT] += 1


@part
def unlink(slot: int, store: Written[Store]) -> None:
    """Take `slot` out of its bucket and its layer's list."""
    s = open_store(store)
    layer = s.links[slot, c.LINK_LAYER]
    bucket = bucket_of(layer, s.links[slot, c.LINK_CELL], s.buckets)
    after, before = s.marks[slot, c.MARK_AFTER], s.marks[slot, c.MARK_BEFORE]
    if s.buckets[bucket] == slot:
        s.buckets[bucket] = s.links[slot, c.LINK_NEXT]
    else:
        previous = s.buckets[bucket]
        while s.links[previous, c.LINK_NEXT] != slot:
            previous = s.links[previous, c.LINK_NEXT]
        s.links[previous, c.LINK_NEXT] = s.links[slot, c.LINK_NEXT]
    if before >= 0:
        s.marks[before, c.MARK_AFTER] = after
    else:
        s.layers[layer, c.LAYER_HEAD] = after
    if after >= 0:
        s.marks[after, c.MARK_BEFORE] = before
    else:
        s.layers[layer, c.LAYER_TAIL] = before
    if s.layers[layer, c.LAYER_SWEEP] == slot:
        s.layers[layer, c.LAYER_SWEEP] = after
    s.layers[layer, c.LAYER_COUNT] -= 1


@part
def claim_slot(store: Written[Store]) -> int:
    """Return a free slot; the caller has made sure that there is one."""
    s = open_store(store)
    slot = int(s.counters[c.COUNTER_FREE])
    if slot >= 0:
        s.counters[c.COUNTER_FREE] = s.links[slot, c.LINK_NEXT]
    else:
        slot = int(s.counters[c.COUNTER_HIGH])
        s.counters[c.COUNTER_HIGH] += 1
    s.counters[c.COUNTER_USED] += 1
    return slot


@part
def free_slot(slot: int, store: Written[Store]) -> None:
    """Put `slot`, which is linked nowhere, at the front of the list of free slots."""
    s = open_store(store)
    s.links[slot, c.LINK_LAYER] = -1
    s.links[slot, c.LINK_NEXT] = s.counters[c.COUNTER_FREE]
    s.counters[c.COUNTER_FREE] = slot
    s.counters[c.COUNTER_USED] -= 1


@part
def remove(slot: int, store: Written[Store]) -> None:
    """Delete the gradient in `slot`; older moving gradients of its source move up one rank."""
    s = open_store(store)
    layer = s.links[slot, c.LINK_LAYER]
    unlink(slot, store)
    if layer % c.LEVELS == c.MOVING:
        cell, rank = s.links[slot, c.LINK_CELL], s.marks[slot, c.MARK_RANK]
        other = s.buckets[bucket_of(layer, cell, s.buckets)]
        while other >= 0:
            same = s.links[other, c.LINK_LAYER] == layer and s.links[other, c.LINK_CELL] == cell
            if same and s.marks[other, c.MARK_RANK] > rank:
                s.marks[other, c.MARK_RANK] -= 1
            other = s.links[other, c.LINK_NEXT]
    free_slot(slot, store)


@part
def insert(slot: int, layer: int, store: Written[Store]) -> None:
    """Link the static gradient whose fields are in `slot` into `layer`, by its position."""
    s = open_store(store)
    level = layer % c.LEVELS
    s.links[slot, c.LINK_LAYER], s.links[slot, c.LINK_CELL], s.marks[slot, c.MARK_RANK] = layer, 0, 0
    if level < c.BOUNDED:
        s.links[slot, c.LINK_CELL] = cell_of(s.near[slot, c.X], s.near[slot, c.Y], s.near[slot, c.Z], s.cells, level)
    link(slot, store)


@lean_kernel
def rebuild(store: Written[Store]) -> None:
    """Fill the buckets again from the lists of the layers, in their order, so that the order in each cell stays."""
    s = open_store(store)
    s.buckets[:] = -1
    for layer in range(len(s.layers)):
        slot = s.layers[layer, c.LAYER_HEAD]
        while slot >= 0:
            bucket = bucket_of(layer, s.links[slot, c.LINK_CELL], s.buckets)
            s.links[slot, c.LINK_NEXT] = s.buckets[bucket]
            s.buckets[bucket] = slot
            slot = s.marks[slot, c.MARK_AFTER]
