"""Aggregation: what a static gradient does to those already stored in its channel."""

import numpy as np

from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import part
from selforg.gradients.store.candidates import store_of
from selforg.gradients.store.columns import (
    AFTER,
    AGGREGATION_DISTANCE,
    ATTRACTION,
    AVERAGE,
    CELL,
    CLOCK,
    COUNT,
    COUNTERS,
    DIFFUSION,
    DROP,
    DUE,
    EXTENT,
    GOAL,
    HEAD,
    LAYER,
    MAX,
    MIN_DIFFUSION,
    NEW,
    NEW_CHANNEL,
    NEW_SOURCE,
    NEXT,
    PERIOD,
    SERIAL,
    SERIALS,
    SOURCE,
    STAMP,
    START,
    UNBOUNDED,
    X,
    Y,
    Z,
)
from selforg.gradients.store.evaporation import evaporate, evaporated_away
from selforg.gradients.store.grid import bucket_of, remove, whole
from selforg.gradients.store.windows import MOST_CELLS, near_cells
from selforg.space import nearest_image, wrapped


@part
def aggregate(slot: int, first: int, rule: int, now: float, store: Bundle) -> bool:
    """Apply `rule` for the gradient in `slot` (not linked yet); False if it is not to be stored.

    first: first layer of its channel and space. The stored gradient that it replaces is removed.
    """
    if rule == DROP:
        return False
    if rule in (NEW_SOURCE, NEW_CHANNEL):
        return replace_older(slot, first, rule, now, store)
    nearest = find_nearest(slot, first, now, store)
    if nearest < 0:
        return True
    near, links, far, marks, layers, buckets, _, counters, _ = store_of(store)
    if rule == AVERAGE:
        kept = merge(slot, nearest, store)
    elif rule == NEW:
        kept = far[slot, STAMP] >= far[nearest, STAMP]
    else:
        reach = near[slot, DIFFUSION] + near[slot, GOAL]
        stored = near[nearest, DIFFUSION] + near[nearest, GOAL]
        kept = reach >= stored if rule == MAX else reach <= stored
    if kept or rule == AVERAGE:
        remove(nearest, links, marks, layers, buckets, counters)
    return kept


@part
def replace_older(slot: int, first: int, rule: int, now: float, store: Bundle) -> bool:
    """Remove the gradients of the same source (or of the whole channel); False if one of them is newer."""
    _, links, far, marks, layers, buckets, _, counters, _ = store_of(store)
    for removing in (False, True):
        for layer in range(first, first + UNBOUNDED + 1):
            other = whole(layers[layer, HEAD])
            while other >= 0:
                following = whole(marks[other, AFTER])
                alive = still_there(other, now, store)
                if alive and (rule != NEW_SOURCE or marks[other, SOURCE] == marks[slot, SOURCE]):
                    if removing:
                        remove(other, links, marks, layers, buckets, counters)
                    elif far[other, STAMP] > far[slot, STAMP]:
                        return False
                other = following
    return True


@part
def still_there(slot: int, now: float, store: Bundle) -> bool:
    """Bring a stored gradient to `now` [s]; False if it evaporated away, it is removed then."""
    near, links, far, marks, layers, buckets, _, counters, settings = store_of(store)
    if now >= near[slot, DUE]:
        evaporate(near, far, slot, now)
        if evaporated_away(near, slot, settings[MIN_DIFFUSION]):
            remove(slot, links, marks, layers, buckets, counters)
            return False
    return True


@part
def find_nearest(slot: int, first: int, now: float, store: Bundle) -> int:
    """Return the stored static gradient nearest to the one in `slot` within the aggregation distance, or -1.

    Among equally near ones the one stored first, so that the order of the walk does not matter.
    """
    near, links, _, marks, layers, buckets, grid, counters, settings = store_of(store)
    window = counters[COUNTERS : COUNTERS + MOST_CELLS]
    radius = settings[AGGREGATION_DISTANCE]
    best, nearest = radius, -1
    for level in range(UNBOUNDED + 1):
        layer = first + level
        members = whole(layers[layer, COUNT])
        if members == 0:
            continue
        cells = -1
        if level < UNBOUNDED:
            cells = near_cells(near[slot, X], near[slot, Y], near[slot, Z], radius, grid, level, float(members), window)
        for index in range(max(cells, 1)):
            other = whole(layers[layer, HEAD])
            if cells == 0:
                break
            if cells > 0:
                other = whole(buckets[bucket_of(layer, int(window[index]), buckets)])
            while other >= 0:
                following = whole(marks[other, AFTER] if cells < 0 else links[other, NEXT])
                here = cells < 0 or (links[other, LAYER] == layer and links[other, CELL] == window[index])
                # most are alive: the tables are handed over only for those that may not be
                if here and (now < near[other, DUE] or still_there(other, now, store)):
                    dx = nearest_image(near[other, X] - near[slot, X], settings[EXTENT])
                    dy = nearest_image(near[other, Y] - near[slot, Y], settings[EXTENT + 1])
                    dz = nearest_image(near[other, Z] - near[slot, Z], settings[EXTENT + 2])
                    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
                    older = (
                        nearest >= 0
                        and (whole(marks[other, SERIAL]) - whole(marks[nearest, SERIAL])) % SERIALS > SERIALS // 2
                    )
                    if distance < best or (distance == best and (nearest < 0 or older)):
                        best, nearest = distance, other
                other = following
    return nearest


@part
def merge(slot: int, other: int, store: Bundle) -> bool:
    """Average the gradient in `slot` with the stored `other`; False if nothing is left of them.

    Same sign: mean radii. Opposite signs weaken each other: differences of the radii, the sign of the larger reach.
    """
    near, links, far, _, _, _, _, _, settings = store_of(store)
    for axis in range(3):
        delta = nearest_image(near[other, X + axis] - near[slot, X + axis], settings[EXTENT + axis])
        near[slot, X + axis] = wrapped(near[slot, X + axis] + 0.5 * delta, settings[EXTENT + axis])
    new_diffusion, new_goal = near[slot, DIFFUSION], near[slot, GOAL]
    diffusion, goal = near[other, DIFFUSION], near[other, GOAL]
    if np.isfinite(near[slot, DUE]):
        far[slot, CLOCK] = near[slot, DUE] - far[slot, PERIOD]
    if links[slot, ATTRACTION] == links[other, ATTRACTION]:
        near[slot, DIFFUSION] = far[slot, START] = 0.5 * (new_diffusion + diffusion)
        near[slot, GOAL] = 0.5 * (new_goal + goal)
        return True
    if diffusion + goal > new_diffusion + new_goal:
        links[slot, ATTRACTION] = links[other, ATTRACTION]
    near[slot, DIFFUSION] = far[slot, START] = difference(new_diffusion, diffusion)
    near[slot, GOAL] = abs(new_goal - goal)
    return not evaporated_away(near, slot, settings[MIN_DIFFUSION])


@part
def difference(one: float, other: float) -> float:
    """Return |one - other| [m], zero for two infinite diffusions."""
    return 0.0 if one == other else abs(one - other)
