"""Aggregation: what a static gradient does to those already stored in its channel."""

import numpy as np

from selforg.cells import bucket_of, remove
from selforg.columns import (
    AFTER,
    AGGREGATION_DISTANCE,
    ATTRACTION,
    AVERAGE,
    CELL,
    CLOCK,
    COUNT,
    DIFFUSION,
    DROP,
    DUE,
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
from selforg.compiled import kernel
from selforg.evaporation import evaporate, evaporated_away
from selforg.gathering import Store
from selforg.space import nearest_image, wrapped
from selforg.windows import near_cells


@kernel
def aggregate(slot: int, first: int, rule: int, now: float, store: Store) -> bool:
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
    numbers, links = store[0], store[1]
    if rule == AVERAGE:
        kept = merge(slot, nearest, store)
    elif rule == NEW:
        kept = numbers[slot, STAMP] >= numbers[nearest, STAMP]
    else:
        reach = numbers[slot, DIFFUSION] + numbers[slot, GOAL]
        stored = numbers[nearest, DIFFUSION] + numbers[nearest, GOAL]
        kept = reach >= stored if rule == MAX else reach <= stored
    if kept or rule == AVERAGE:
        remove(nearest, links, store[2], store[3], store[5])
    return kept


@kernel
def replace_older(slot: int, first: int, rule: int, now: float, store: Store) -> bool:
    """Remove the gradients of the same source (or of the whole channel); False if one of them is newer."""
    numbers, links, layers, buckets, _, counters, _, _, _ = store
    for removing in (False, True):
        for layer in range(first, first + UNBOUNDED + 1):
            other = int(layers[layer, HEAD])
            while other >= 0:
                following = int(links[other, AFTER])
                alive = still_there(other, now, store)
                if alive and (rule != NEW_SOURCE or links[other, SOURCE] == links[slot, SOURCE]):
                    if removing:
                        remove(other, links, layers, buckets, counters)
                    elif numbers[other, STAMP] > numbers[slot, STAMP]:
                        return False
                other = following
    return True


@kernel
def still_there(slot: int, now: float, store: Store) -> bool:
    """Bring a stored gradient to `now` [s]; False if it evaporated away, it is removed then."""
    numbers = store[0]
    if now >= numbers[slot, DUE]:
        evaporate(numbers, slot, now)
        if evaporated_away(numbers, slot, store[6][MIN_DIFFUSION]):
            remove(slot, store[1], store[2], store[3], store[5])
            return False
    return True


@kernel
def find_nearest(slot: int, first: int, now: float, store: Store) -> int:
    """Return the stored static gradient nearest to the one in `slot` within the aggregation distance, or -1.

    Among equally near ones the one stored first, so that the order of the walk does not matter.
    """
    numbers, links, layers, buckets, grid, _, settings, window, extent = store
    radius = settings[AGGREGATION_DISTANCE]
    best, nearest = radius, -1
    for level in range(UNBOUNDED + 1):
        layer = first + level
        members = int(layers[layer, COUNT])
        if members == 0:
            continue
        cells = -1
        if level < UNBOUNDED:
            cells = near_cells(
                numbers[slot, X], numbers[slot, Y], numbers[slot, Z], radius, grid, level, float(members), window
            )
        for index in range(max(cells, 1)):
            other = int(layers[layer, HEAD])
            if cells == 0:
                break
            if cells > 0:
                other = int(buckets[bucket_of(layer, int(window[index]), buckets)])
            while other >= 0:
                following = int(links[other, AFTER if cells < 0 else NEXT])
                here = cells < 0 or (links[other, LAYER] == layer and links[other, CELL] == window[index])
                # most are alive: the tables are handed over only for those that may not be
                if here and (now < numbers[other, DUE] or still_there(other, now, store)):
                    dx = nearest_image(numbers[other, X] - numbers[slot, X], extent[0])
                    dy = nearest_image(numbers[other, Y] - numbers[slot, Y], extent[1])
                    dz = nearest_image(numbers[other, Z] - numbers[slot, Z], extent[2])
                    distance = np.sqrt(dx * dx + dy * dy + dz * dz)
                    older = (
                        nearest >= 0
                        and (int(links[other, SERIAL]) - int(links[nearest, SERIAL])) % SERIALS > SERIALS // 2
                    )
                    if distance < best or (distance == best and (nearest < 0 or older)):
                        best, nearest = distance, other
                other = following
    return nearest


@kernel
def merge(slot: int, other: int, store: Store) -> bool:
    """Average the gradient in `slot` with the stored `other`; False if nothing is left of them.

    Same sign: mean radii. Opposite signs weaken each other: differences of the radii, the sign of the larger reach.
    """
    numbers, links, extent = store[0], store[1], store[8]
    for axis in range(3):
        delta = nearest_image(numbers[other, X + axis] - numbers[slot, X + axis], extent[axis])
        numbers[slot, X + axis] = wrapped(numbers[slot, X + axis] + 0.5 * delta, extent[axis])
    new_diffusion, new_goal = numbers[slot, DIFFUSION], numbers[slot, GOAL]
    diffusion, goal = numbers[other, DIFFUSION], numbers[other, GOAL]
    if np.isfinite(numbers[slot, DUE]):
        numbers[slot, CLOCK] = numbers[slot, DUE] - numbers[slot, PERIOD]
    if links[slot, ATTRACTION] == links[other, ATTRACTION]:
        numbers[slot, DIFFUSION] = numbers[slot, START] = 0.5 * (new_diffusion + diffusion)
        numbers[slot, GOAL] = 0.5 * (new_goal + goal)
        return True
    if diffusion + goal > new_diffusion + new_goal:
        links[slot, ATTRACTION] = links[other, ATTRACTION]
    numbers[slot, DIFFUSION] = numbers[slot, START] = difference(new_diffusion, diffusion)
    numbers[slot, GOAL] = abs(new_goal - goal)
    return not evaporated_away(numbers, slot, store[6][MIN_DIFFUSION])


@kernel
def difference(one: float, other: float) -> float:
    """Return |one - other| [m], zero for two infinite diffusions."""
    return 0.0 if one == other else abs(one - other)
