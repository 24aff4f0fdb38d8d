"""Storing: how the buffer changes when gradients arrive, one after the other, many in one call."""

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel, long_kernel, part
from selforg.compiler.records import Handle, Written
from selforg.gradients.store import columns as c
from selforg.gradients.store.aggregation import aggregate
from selforg.gradients.store.evaporation import evaporate_whole_seconds, evaporated_away, start_evaporation, still_there
from selforg.gradients.store.linking import (
    claim_slot,
    first_layer,
    free_slot,
    insert,
    level_for,
    link,
    remove,
    space_of,
)
from selforg.gradients.store.records import Left, Poses, Store, open_left, open_poses, open_store
from selforg.grid import bucket_of

SWEPT_PER_STORE = 2  # gradients checked for each one stored, so that evaporated ones are freed as fast as new ones come


@long_kernel
def store_rows(messages: Floats, tags: Ints, now: float, store: Written[Store]) -> None:
    """Store messages (M, MESSAGE_COLUMNS) with tags (M, TAG_COLUMNS) in their order; there is room for all.

    The serial number of the first is that of the last message + 1, and so on.
    """
    for index in range(len(messages)):
        store_one(messages[index], tags[index], now, store)


@long_kernel
def deposit_rows(now: float, rows: Ints, left: Handle[Left], poses: Handle[Poses], store: Written[Store]) -> int:
    """Leave a gradient at the newest pose of each of `rows` (R,); a step, see `selforg.program`.

    If the tables have to be made larger or tidied first, nothing is stored, and the result is 1.
    """
    s, p, message, tag = open_store(store), open_poses(poses), open_left(left).message[0], open_left(left).tag[0]
    full = s.counters[c.COUNTER_USED] + len(rows) > len(s.links)
    if full or s.counters[c.COUNTER_SERIAL] >= s.counters[c.COUNTER_TIDY_AT]:
        return 1
    for index in range(len(rows)):
        row = int(rows[index])
        if p.rows[row, c.ROW_POSES] == 0:
            continue
        for axis in range(3):
            message[c.X + axis] = p.own[row, 0, c.X + axis]
        message[c.MESSAGE_FAR + c.FAR_STAMP] = message[c.MESSAGE_FAR + c.FAR_CLOCK] = now
        tag[c.TAG_SPACE], tag[c.TAG_SOURCE] = space_of(row, p.teams, store), row
        store_one(message, tag, now, store)
    return 0


@lean_kernel
def has_listener(now: float, rows: Ints, store: Handle[Store]) -> int:
    """Return 1 if somebody is told who leaves what; a step, see `selforg.program`."""
    return int(open_store(store).counters[c.COUNTER_LISTENED])


@part
def store_one(message: Floats, tag: Ints, now: float, store: Written[Store]) -> None:
    """Store one message by the rules of its channel, or drop it."""
    s = open_store(store)
    if s.whole_seconds:
        evaporate_space(int(tag[c.TAG_SPACE]), now, store)
    s.counters[c.COUNTER_SERIAL] += 1
    slot = claim_slot(store)
    for column in range(c.MESSAGE_FAR):
        s.near[slot, column] = message[column]
    for column in range(c.FAR_COLUMNS):
        s.far[slot, column] = message[c.MESSAGE_FAR + column]
    s.marks[slot, c.MARK_SOURCE], s.links[slot, c.LINK_SIGN] = tag[c.TAG_SOURCE], tag[c.TAG_SIGN]
    s.marks[slot, c.MARK_SERIAL] = s.counters[c.COUNTER_SERIAL] % c.SERIALS
    s.marks[slot, c.MARK_KEY] = tag[c.TAG_KEY]
    start_evaporation(slot, now, store)
    first = first_layer(int(tag[c.TAG_CHANNEL]), int(tag[c.TAG_SPACE]), store)
    if tag[c.TAG_MOVING]:
        kept = store_moving(slot, first + c.MOVING, now, store)
    else:
        free = s.counters[c.COUNTER_FREE]
        kept = aggregate(slot, first, int(s.rules[tag[c.TAG_CHANNEL]]), now, store)
        if kept:
            if s.counters[c.COUNTER_FREE] != free:
                slot = reuse_place(slot, store)
            layer = first + level_for(slot, store)
            insert(slot, layer, store)
            sweep(layer, now, store)
    if not kept:
        free_slot(slot, store)
    elif not s.whole_seconds and evaporated_away(slot, store):
        remove(slot, store)


@part
def reuse_place(slot: int, store: Written[Store]) -> int:
    """Move the gradient in `slot`, which is not linked yet, to the slot that was freed last, and return that.

    The gradient that it replaces lay there. So neighbours in space stay neighbours in memory, which walks read faster
    (docs/decisions/0113-places-in-memory.md).
    """
    s = open_store(store)
    place = claim_slot(store)
    for column in range(c.NEAR_COLUMNS):
        s.near[place, column] = s.near[slot, column]
    for column in range(c.FAR_COLUMNS):
        s.far[place, column] = s.far[slot, column]
    s.links[place, c.LINK_SIGN] = s.links[slot, c.LINK_SIGN]
    for column in range(c.MARK_COLUMNS):
        s.marks[place, column] = s.marks[slot, column]
    free_slot(slot, store)
    return place


@part
def store_moving(slot: int, layer: int, now: float, store: Written[Store]) -> bool:
    """Link a moving gradient as the newest of its source; if it is not newer than the last one, return False."""
    s = open_store(store)
    source = s.marks[slot, c.MARK_SOURCE]
    bucket = bucket_of(layer, source, s.buckets)
    other = s.buckets[bucket]
    while other >= 0:
        following = s.links[other, c.LINK_NEXT]
        same = s.links[other, c.LINK_LAYER] == layer and s.links[other, c.LINK_CELL] == source
        newer = s.far[slot, c.FAR_STAMP] > s.far[other, c.FAR_STAMP]
        if same and still_there(other, now, store) and not newer:
            return False
        other = following
    if s.history == 0:
        return False
    other = s.buckets[bucket]
    while other >= 0:
        following = s.links[other, c.LINK_NEXT]
        if s.links[other, c.LINK_LAYER] == layer and s.links[other, c.LINK_CELL] == source:
            s.marks[other, c.MARK_RANK] += 1
            if s.marks[other, c.MARK_RANK] >= s.history:
                remove(other, store)
        other = following
    s.links[slot, c.LINK_LAYER], s.links[slot, c.LINK_CELL], s.marks[slot, c.MARK_RANK] = layer, source, 0
    link(slot, store)
    return True


@part
def sweep(layer: int, now: float, store: Written[Store]) -> None:
    """Look at the next SWEPT_PER_STORE gradients of a layer and delete those that evaporated away."""
    s = open_store(store)
    for _ in range(SWEPT_PER_STORE):
        slot = s.layers[layer, c.LAYER_SWEEP]
        if slot < 0:
            slot = s.layers[layer, c.LAYER_HEAD]
            if slot < 0:
                return
        s.layers[layer, c.LAYER_SWEEP] = s.marks[slot, c.MARK_AFTER]
        still_there(slot, now, store)


@lean_kernel
def evaporate_space(space: int, now: float, store: Written[Store]) -> None:
    """Evaporate everything in one space up to `now` [s] and delete those that have disappeared."""
    s = open_store(store)
    for channel in range(len(s.rules)):
        first = first_layer(channel, space, store)
        for layer in range(first, first + c.LEVELS):
            slot = s.layers[layer, c.LAYER_HEAD]
            while slot >= 0:
                following = s.marks[slot, c.MARK_AFTER]
                if s.whole_seconds and s.far[slot, c.FAR_FACTOR] < 1.0:
                    evaporate_whole_seconds(slot, now, store)
                if still_there(slot, now, store) and evaporated_away(slot, store):
                    remove(slot, store)
                slot = following


@lean_kernel
def clear_space(space: int, store: Written[Store]) -> None:
    """Delete everything in one space and set its lists back to their first state."""
    s = open_store(store)
    for channel in range(len(s.rules)):
        first = first_layer(channel, space, store)
        for layer in range(first, first + c.LEVELS):
            while s.layers[layer, c.LAYER_HEAD] >= 0:
                remove(s.layers[layer, c.LAYER_HEAD], store)
            s.layers[layer, c.LAYER_SWEEP], s.layers[layer, c.LAYER_GONE] = -1, 0
