"""Storing: what happens to the buffer when a gradient arrives. One message after the other, many in one call."""

from selforg.arrays import Floats, Ints
from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import lean_kernel, part
from selforg.gradients.store.aggregation import aggregate
from selforg.gradients.store.candidates import store_of
from selforg.gradients.store.columns import (
    AFTER,
    ATTRACTION,
    CELL,
    CLOCK,
    DUE,
    FAR,
    FREE,
    HEAD,
    HISTORY,
    KEY,
    LAST_SERIAL,
    LAYER,
    LEVELS,
    MESSAGE_COLUMNS,
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
    TIDY_AT,
    USED,
    WHOLE_SECONDS,
    X,
    Y,
    Z,
)
from selforg.gradients.store.evaporation import evaporate, evaporate_whole_seconds, evaporated_away, start_evaporation
from selforg.gradients.store.grid import (
    bucket_of,
    insert,
    layer_of,
    level_for,
    link,
    remove,
    space_of,
    take_slot,
    whole,
)
from selforg.gradients.store.pose_cells import poses_of

SWEPT_PER_STORE = 2  # looked at for each one stored: what evaporates unseen is freed at the rate at which it comes


@lean_kernel
def store_rows(messages: Floats, tags: Ints, rules: Ints, now: float, store: Bundle) -> None:
    """Store messages (M, MESSAGE_COLUMNS) with tags (M, TAG_COLUMNS) in their order; there is room for all.

    rules: (channels,) aggregation rule of each channel. SERIAL of the first is LAST_SERIAL + 1, and so on.
    """
    for index in range(len(messages)):
        store_one(messages[index], tags[index], rules, now, store)


@lean_kernel
def deposit_rows(rows: Ints, message: Floats, tag: Ints, rules: Ints, now: float, poses: Bundle, store: Bundle) -> bool:
    """Store `message` (MESSAGE_COLUMNS,) with `tag` (TAG_COLUMNS,) once at the newest pose of each of `rows` (R,).

    False, and nothing is stored, where the tables have to be made larger or tidied first.
    """
    _, links, _, _, _, _, _, counters, _ = store_of(store)
    if counters[USED] + len(rows) > len(links) or counters[LAST_SERIAL] >= counters[TIDY_AT]:
        return False
    own, row_table, _, _, _, _, _, _, _ = poses_of(poses)
    for index in range(len(rows)):
        row = int(rows[index])
        if row_table[row, POSES] == 0:
            continue
        message[X], message[Y], message[Z] = own[row, 0, X], own[row, 0, Y], own[row, 0, Z]
        message[FAR + STAMP] = message[FAR + CLOCK] = now
        tag[TAG_SPACE], tag[TAG_SOURCE] = space_of(row, row_table, counters), row
        store_one(message, tag, rules, now, store)
    return True


@part
def store_one(message: Floats, tag: Ints, rules: Ints, now: float, store: Bundle) -> None:
    """Store one message by the rules of its channel, or drop it."""
    near, links, far, marks, layers, buckets, grid, counters, settings = store_of(store)
    whole_seconds = settings[WHOLE_SECONDS] > 0.0
    if whole_seconds:
        evaporate_space(int(tag[TAG_SPACE]), now, store)
    counters[LAST_SERIAL] += 1
    slot = take_slot(links, counters)
    for column in range(FAR):
        near[slot, column] = message[column]
    for column in range(MESSAGE_COLUMNS - FAR):
        far[slot, column] = message[FAR + column]
    marks[slot, SOURCE], links[slot, ATTRACTION] = tag[TAG_SOURCE], tag[TAG_SIGN]
    marks[slot, SERIAL], marks[slot, KEY] = counters[LAST_SERIAL] % SERIALS, tag[TAG_KEY]
    start_evaporation(near, far, slot, now, whole_seconds)
    first = layer_of(int(tag[TAG_CHANNEL]), int(tag[TAG_SPACE]), 0, counters)
    if tag[TAG_MOVING]:
        kept = store_moving(slot, first + MOVING, store)
    else:
        kept = aggregate(slot, first, int(rules[tag[TAG_CHANNEL]]), now, store)
        if kept:
            layer = first + level_for(slot, near, grid)
            insert(slot, layer, near, links, marks, layers, buckets, grid)
            sweep(layer, SWEPT_PER_STORE, now, store)
    if not kept:
        links[slot, LAYER] = -1
        links[slot, NEXT] = counters[FREE]
        counters[FREE] = slot
        counters[USED] -= 1
    elif not whole_seconds and evaporated_away(near, slot, settings[MIN_DIFFUSION]):
        remove(slot, links, marks, layers, buckets, counters)


@part
def store_moving(slot: int, layer: int, store: Bundle) -> bool:
    """Link a moving gradient as the newest of its source; False if it is not newer than the last one."""
    _, links, far, marks, layers, buckets, _, counters, settings = store_of(store)
    history = int(settings[HISTORY])
    source = whole(marks[slot, SOURCE])
    bucket = bucket_of(layer, source, buckets)
    other = whole(buckets[bucket])
    while other >= 0:
        if links[other, LAYER] == layer and links[other, CELL] == source and marks[other, RANK] == 0:
            if far[slot, STAMP] <= far[other, STAMP]:
                return False
            break
        other = whole(links[other, NEXT])
    if history == 0:
        return False
    other = whole(buckets[bucket])
    while other >= 0:
        following = whole(links[other, NEXT])
        if links[other, LAYER] == layer and links[other, CELL] == source:
            marks[other, RANK] += 1
            if marks[other, RANK] >= history:
                remove(other, links, marks, layers, buckets, counters)
        other = following
    links[slot, LAYER], links[slot, CELL], marks[slot, RANK] = layer, source, 0
    link(slot, links, marks, layers, buckets)
    return True


@part
def sweep(layer: int, amount: int, now: float, store: Bundle) -> None:
    """Look at the next `amount` gradients of a layer and free those that evaporated unseen."""
    near, links, far, marks, layers, buckets, _, counters, settings = store_of(store)
    for _ in range(amount):
        slot = whole(layers[layer, SWEEP])
        if slot < 0:
            slot = whole(layers[layer, HEAD])
            if slot < 0:
                return
        layers[layer, SWEEP] = marks[slot, AFTER]
        if now >= near[slot, DUE]:
            evaporate(near, far, slot, now)
            if evaporated_away(near, slot, settings[MIN_DIFFUSION]):
                remove(slot, links, marks, layers, buckets, counters)


@lean_kernel
def evaporate_space(space: int, now: float, store: Bundle) -> None:
    """Bring everything in one space to `now` [s] and delete what evaporated away."""
    near, links, far, marks, layers, buckets, _, counters, settings = store_of(store)
    channels = len(layers) // (LEVELS * int(counters[SPACES]))
    for channel in range(channels):
        first = layer_of(channel, space, 0, counters)
        for layer in range(first, first + LEVELS):
            slot = whole(layers[layer, HEAD])
            while slot >= 0:
                following = whole(marks[slot, AFTER])
                if settings[WHOLE_SECONDS] > 0.0:
                    evaporate_whole_seconds(near, far, slot, now)
                elif now >= near[slot, DUE]:
                    evaporate(near, far, slot, now)
                if evaporated_away(near, slot, settings[MIN_DIFFUSION]):
                    remove(slot, links, marks, layers, buckets, counters)
                slot = following


@lean_kernel
def clear_space(space: int, store: Bundle) -> None:
    """Delete everything in one space and bring its lists to where they were at the beginning."""
    _, links, _, marks, layers, buckets, _, counters, _ = store_of(store)
    channels = len(layers) // (LEVELS * int(counters[SPACES]))
    for channel in range(channels):
        first = layer_of(channel, space, 0, counters)
        for layer in range(first, first + LEVELS):
            while layers[layer, HEAD] >= 0:
                remove(whole(layers[layer, HEAD]), links, marks, layers, buckets, counters)
            layers[layer, SWEEP] = -1
