"""Storing: what happens to the buffer when a gradient arrives. One message after the other, many in one call."""

from selforg.aggregating import aggregate
from selforg.arrays import Floats, Ints
from selforg.cells import (
    bucket_of,
    insert,
    layer_of,
    level_for,
    link,
    remove,
    space_of,
    take_slot,
)
from selforg.columns import (
    AFTER,
    ATTRACTION,
    CELL,
    CLOCK,
    DUE,
    FREE,
    HEAD,
    HISTORY,
    KEY,
    LAST_SERIAL,
    LAYER,
    LEVELS,
    MIN_DIFFUSION,
    MOVING,
    NEXT,
    POSES,
    RANK,
    SERIAL,
    SERIALS,
    SOURCE,
    SPACES,
    STAMP,
    SWEEP,
    TAG_CHANNEL,
    TAG_KEY,
    TAG_MOVING,
    TAG_SIGN,
    TAG_SOURCE,
    TAG_SPACE,
    USED,
    WHOLE_SECONDS,
    X,
    Y,
    Z,
)
from selforg.compiled import kernel
from selforg.evaporation import evaporate, evaporate_whole_seconds, evaporated_away, start_evaporation
from selforg.gathering import Store
from selforg.pose_cells import Poses

SWEPT_PER_STORE = 2  # looked at for each one stored: what evaporates unseen is freed at the rate at which it comes


@kernel
def store_rows(messages: Floats, tags: Ints, rules: Ints, now: float, store: Store) -> None:
    """Store messages (M, GRADIENT_COLUMNS) with tags (M, TAG_COLUMNS) in their order; there is room for all.

    rules: (channels,) aggregation rule of each channel. SERIAL of the first is LAST_SERIAL + 1, and so on.
    """
    for index in range(len(messages)):
        store_one(messages[index], tags[index], rules, now, store)


@kernel
def deposit_rows(rows: Ints, message: Floats, tag: Ints, rules: Ints, now: float, poses: Poses, store: Store) -> None:
    """Store `message` (GRADIENT_COLUMNS,) with `tag` (TAG_COLUMNS,) once at the newest pose of each of `rows` (R,)."""
    own, row_table = poses[0], poses[1]
    for index in range(len(rows)):
        row = int(rows[index])
        if row_table[row, POSES] == 0:
            continue
        message[X], message[Y], message[Z] = own[row, 0, X], own[row, 0, Y], own[row, 0, Z]
        message[STAMP] = message[CLOCK] = now
        tag[TAG_SPACE], tag[TAG_SOURCE] = space_of(row, row_table, store[5]), row
        store_one(message, tag, rules, now, store)


@kernel
def store_one(message: Floats, tag: Ints, rules: Ints, now: float, store: Store) -> None:
    """Store one message by the rules of its channel, or drop it."""
    numbers, links, _, _, _, counters, settings, _, _ = store
    whole_seconds = settings[WHOLE_SECONDS] > 0.0
    if whole_seconds:
        evaporate_space(int(tag[TAG_SPACE]), now, store)
    counters[LAST_SERIAL] += 1
    slot = take_slot(links, counters)
    numbers[slot] = message
    links[slot, SOURCE], links[slot, ATTRACTION] = tag[TAG_SOURCE], tag[TAG_SIGN]
    links[slot, SERIAL], links[slot, KEY] = counters[LAST_SERIAL] % SERIALS, tag[TAG_KEY]
    start_evaporation(numbers, slot, now, whole_seconds)
    first = layer_of(int(tag[TAG_CHANNEL]), int(tag[TAG_SPACE]), 0, counters)
    if tag[TAG_MOVING]:
        kept = store_moving(slot, first + MOVING, store)
    else:
        kept = aggregate(slot, first, int(rules[tag[TAG_CHANNEL]]), now, store)
        if kept:
            layer = first + level_for(slot, numbers, store[4])
            insert(slot, layer, numbers, links, store[2], store[3], store[4])
            sweep(layer, SWEPT_PER_STORE, now, store)
    if not kept:
        links[slot, LAYER] = -1
        links[slot, NEXT] = counters[FREE]
        counters[FREE] = slot
        counters[USED] -= 1
    elif not whole_seconds and evaporated_away(numbers, slot, settings[MIN_DIFFUSION]):
        remove(slot, links, store[2], store[3], counters)


@kernel
def store_moving(slot: int, layer: int, store: Store) -> bool:
    """Link a moving gradient as the newest of its source; False if it is not newer than the last one."""
    numbers, links, layers, buckets, _, counters, settings, _, _ = store
    history = int(settings[HISTORY])
    source = int(links[slot, SOURCE])
    bucket = bucket_of(layer, source, buckets)
    other = int(buckets[bucket])
    while other >= 0:
        if links[other, LAYER] == layer and links[other, CELL] == source and links[other, RANK] == 0:
            if numbers[slot, STAMP] <= numbers[other, STAMP]:
                return False
            break
        other = int(links[other, NEXT])
    if history == 0:
        return False
    other = int(buckets[bucket])
    while other >= 0:
        following = int(links[other, NEXT])
        if links[other, LAYER] == layer and links[other, CELL] == source:
            links[other, RANK] += 1
            if links[other, RANK] >= history:
                remove(other, links, layers, buckets, counters)
        other = following
    links[slot, LAYER], links[slot, CELL], links[slot, RANK] = layer, source, 0
    link(slot, links, layers, buckets)
    return True


@kernel
def sweep(layer: int, amount: int, now: float, store: Store) -> None:
    """Look at the next `amount` gradients of a layer and free those that evaporated unseen."""
    numbers, links, layers, buckets, _, counters, settings, _, _ = store
    for _ in range(amount):
        slot = int(layers[layer, SWEEP])
        if slot < 0:
            slot = int(layers[layer, HEAD])
            if slot < 0:
                return
        layers[layer, SWEEP] = links[slot, AFTER]
        if now >= numbers[slot, DUE]:
            evaporate(numbers, slot, now)
            if evaporated_away(numbers, slot, settings[MIN_DIFFUSION]):
                remove(slot, links, layers, buckets, counters)


@kernel
def evaporate_space(space: int, now: float, store: Store) -> None:
    """Bring everything in one space to `now` [s] and delete what evaporated away."""
    numbers, links, layers, buckets, _, counters, settings, _, _ = store
    channels = len(layers) // (LEVELS * int(counters[SPACES]))
    for channel in range(channels):
        first = layer_of(channel, space, 0, counters)
        for layer in range(first, first + LEVELS):
            slot = int(layers[layer, HEAD])
            while slot >= 0:
                following = int(links[slot, AFTER])
                if settings[WHOLE_SECONDS] > 0.0:
                    evaporate_whole_seconds(numbers, slot, now)
                elif now >= numbers[slot, DUE]:
                    evaporate(numbers, slot, now)
                if evaporated_away(numbers, slot, settings[MIN_DIFFUSION]):
                    remove(slot, links, layers, buckets, counters)
                slot = following


@kernel
def clear_space(space: int, store: Store) -> None:
    """Delete everything in one space and bring its lists to where they were at the beginning."""
    _, links, layers, buckets, _, counters, _, _, _ = store
    channels = len(layers) // (LEVELS * int(counters[SPACES]))
    for channel in range(channels):
        first = layer_of(channel, space, 0, counters)
        for layer in range(first, first + LEVELS):
            while layers[layer, HEAD] >= 0:
                remove(int(layers[layer, HEAD]), links, layers, buckets, counters)
            layers[layer, SWEEP] = -1
