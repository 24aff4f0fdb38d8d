"""Aggregation: what a static gradient does to those already stored in its channel."""

import numpy as np

from selforg.compiler.decorators import part
from selforg.compiler.records import Handle, Written
from selforg.gradients.settings import (
    AGGREGATE_AVERAGE,
    AGGREGATE_DROP,
    AGGREGATE_MAX,
    AGGREGATE_NEW,
    AGGREGATE_NEW_CHANNEL,
    AGGREGATE_NEW_SOURCE,
)
from selforg.gradients.store import columns as c
from selforg.gradients.store.evaporation import evaporated_away, still_there
from selforg.gradients.store.linking import remove
from selforg.gradients.store.records import Store, open_store
from selforg.grid import bucket_of, near_cells
from selforg.space import nearest_image, squared_length, wrapped


@part
def aggregate(slot: int, first: int, rule: int, now: float, store: Written[Store]) -> bool:
    """Apply `rule` to the gradient in `slot`, which is not linked yet; return whether it is to be stored.

    first: first layer of its channel and space. The stored gradient that it replaces is removed.
    """
    if rule == AGGREGATE_DROP:
        return False
    if rule in (AGGREGATE_NEW_SOURCE, AGGREGATE_NEW_CHANNEL):
        return replace_older(slot, first, rule, now, store)
    nearest = find_nearest(slot, first, now, store)
    if nearest < 0:
        return True
    s = open_store(store)
    if rule == AGGREGATE_AVERAGE:
        kept = merge(slot, nearest, store)
    elif rule == AGGREGATE_NEW:
        kept = s.far[slot, c.FAR_STAMP] >= s.far[nearest, c.FAR_STAMP]
    else:
        reach = s.near[slot, c.DIFFUSION] + s.near[slot, c.GOAL_RADIUS]
        stored = s.near[nearest, c.DIFFUSION] + s.near[nearest, c.GOAL_RADIUS]
        kept = reach >= stored if rule == AGGREGATE_MAX else reach <= stored
    if kept or rule == AGGREGATE_AVERAGE:
        remove(nearest, store)
    return kept


@part
def replace_older(slot: int, first: int, rule: int, now: float, store: Written[Store]) -> bool:
    """Remove the gradients of the same source (or of the whole channel); if one of them is newer, return False."""
    s = open_store(store)
    for removing in (False, True):
        for layer in range(first, first + c.UNBOUNDED + 1):
            other = s.layers[layer, c.LAYER_HEAD]
            while other >= 0:
                following = s.marks[other, c.MARK_AFTER]
                alive = still_there(other, now, store)
                same_source = s.marks[other, c.MARK_SOURCE] == s.marks[slot, c.MARK_SOURCE]
                if alive and (rule != AGGREGATE_NEW_SOURCE or same_source):
                    if removing:
                        remove(other, store)
                    elif s.far[other, c.FAR_STAMP] > s.far[slot, c.FAR_STAMP]:
                        return False
                other = following
    return True


@part
def find_nearest(slot: int, first: int, now: float, store: Written[Store]) -> int:
    """Return the stored static gradient nearest to the one in `slot` within the aggregation distance, or -1.

    Among equally near ones it is the one stored first, so that the order of the walk does not matter.
    """
    s = open_store(store)
    radius = s.aggregation_distance
    best, nearest = radius, -1
    x, y, z = s.near[slot, c.X], s.near[slot, c.Y], s.near[slot, c.Z]
    for level in range(c.UNBOUNDED + 1):
        layer = first + level
        members = s.layers[layer, c.LAYER_COUNT]
        if members == 0:
            continue
        cells = -1
        if level < c.UNBOUNDED:
            cells = near_cells(x, y, z, radius, s.cells, level, float(members), s.window)
        for index in range(max(cells, 1)):
            other = s.layers[layer, c.LAYER_HEAD]
            if cells == 0:
                break
            if cells > 0:
                other = s.buckets[bucket_of(layer, int(s.window[index]), s.buckets)]
            while other >= 0:
                following = s.marks[other, c.MARK_AFTER] if cells < 0 else s.links[other, c.LINK_NEXT]
                here = cells < 0 or (
                    s.links[other, c.LINK_LAYER] == layer and s.links[other, c.LINK_CELL] == s.window[index]
                )
                # most are not due, and need no call
                if here and (now < s.near[other, c.NEAR_DUE] or still_there(other, now, store)):
                    dx, dy, dz = s.near[other, c.X] - x, s.near[other, c.Y] - y, s.near[other, c.Z] - z
                    distance = np.sqrt(squared_length(dx, dy, dz, s.extent))
                    if distance < best or (distance == best and (nearest < 0 or older(other, nearest, store))):
                        best, nearest = distance, other
                other = following
    return nearest


@part
def older(one: int, other: int, store: Handle[Store]) -> bool:
    """Return whether the gradient in slot `one` was stored before the one in slot `other`."""
    marks = open_store(store).marks
    return (int(marks[one, c.MARK_SERIAL]) - int(marks[other, c.MARK_SERIAL])) % c.SERIALS > c.SERIALS // 2


@part
def merge(slot: int, other: int, store: Written[Store]) -> bool:
    """Average the gradient in `slot` with the stored `other`; return whether anything is left of them.

    Same sign: mean radii. Opposite signs weaken each other: differences of the radii, the sign of the larger reach.
    """
    s = open_store(store)
    near, far = s.near, s.far
    for axis in range(3):
        delta = nearest_image(near[other, c.X + axis] - near[slot, c.X + axis], s.extent[axis])
        near[slot, c.X + axis] = wrapped(near[slot, c.X + axis] + 0.5 * delta, s.extent[axis])
    new_diffusion, new_goal = near[slot, c.DIFFUSION], near[slot, c.GOAL_RADIUS]
    diffusion, goal = near[other, c.DIFFUSION], near[other, c.GOAL_RADIUS]
    if np.isfinite(near[slot, c.NEAR_DUE]):
        far[slot, c.FAR_CLOCK] = near[slot, c.NEAR_DUE] - far[slot, c.FAR_PERIOD]
    if s.links[slot, c.LINK_SIGN] == s.links[other, c.LINK_SIGN]:
        near[slot, c.DIFFUSION] = far[slot, c.FAR_START] = 0.5 * (new_diffusion + diffusion)
        near[slot, c.GOAL_RADIUS] = 0.5 * (new_goal + goal)
        return True
    if diffusion + goal > new_diffusion + new_goal:
        s.links[slot, c.LINK_SIGN] = s.links[other, c.LINK_SIGN]
    near[slot, c.DIFFUSION] = far[slot, c.FAR_START] = difference(new_diffusion, diffusion)
    near[slot, c.GOAL_RADIUS] = abs(new_goal - goal)
    return not evaporated_away(slot, store)


@part
def difference(one: float, other: float) -> float:
    """Return |one - other| [m], zero for two infinite diffusions."""
    return 0.0 if one == other else abs(one - other)
