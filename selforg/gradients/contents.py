"""What a buffer has of one team: taken out, and put into another buffer for another team.

The order of storing stays, so that the team finds the same gradients in the same order, wherever they are.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Written
from selforg.gradients.delivery import Post
from selforg.gradients.store import columns as c
from selforg.gradients.store.linking import claim_slot, link
from selforg.gradients.store.records import Store, open_store


class TeamContents(NamedTuple):
    """The gradients of one team, K of them, layer by layer in the order of storing."""

    near: Floats  # (K, NEAR_COLUMNS)
    far: Floats  # (K, FAR_COLUMNS)
    links: Links  # (K, LINK_COLUMNS); LINK_LAYER counts the layers of the team
    marks: Links  # (K, MARK_COLUMNS); MARK_SERIAL counts back from the last message of the buffer, MARK_SOURCE first
    # the rows of the team, then `sources`
    sweeps: Ints  # (layers of the team,) which gradient is checked next, -1: the first
    gone: Links  # (layers of the team,) column LAYER_GONE
    channels: tuple[str, ...]  # by their numbers
    keys: tuple[str, ...]  # names of values, by their numbers
    sources: tuple[str, ...]  # names of senders that are not rows, by their numbers
    payloads: dict[int, Any]  # by MARK_SERIAL
    mail: list[Post]  # under way; rows count from the team's first


def team_contents(buffer: Any, team: int) -> TeamContents:  # noqa: ANN401  (an SoBuffer, which stands above this module)
    """Return the stored gradients of a team, with its messages under way."""
    store, channels = buffer.table.record, buffer.channels.numbered()
    layers = buffer.layers_of(team, np.arange(len(channels)))
    slots = np.zeros(int(store.layers[layers, c.LAYER_COUNT].sum()), dtype=np.int64)
    sweeps = np.full(len(layers), -1)
    list_slots(layers, slots, sweeps, buffer.table.packed.handle)
    links, marks = store.links[slots], store.marks[slots]
    links[:, c.LINK_LAYER] = np.repeat(np.arange(len(layers)), store.layers[layers, c.LAYER_COUNT])
    senders, members, rows = marks[:, c.MARK_SOURCE], buffer.poses.members(team), buffer.poses.rows
    own = np.where(senders < rows, senders - members[0], senders - rows + len(members))
    senders[:] = np.where(senders < 0, -1, own)
    serials, last = marks[:, c.MARK_SERIAL], int(store.counters[c.COUNTER_SERIAL])
    payloads = {}
    if buffer.payloads:
        found = {serial: buffer.payloads[serial] for serial in serials.tolist() if serial in buffer.payloads}
        payloads = {(last - serial) % c.SERIALS: payload for serial, payload in found.items()}
    serials[:] = (last - serials.astype(np.int64)) % c.SERIALS
    names = channels, buffer.keys.numbered(), buffer.sources.numbered()
    mail = buffer.mail.to(members)
    for _, _, tags in mail:
        tags[:, [c.TAG_SPACE, c.TAG_SOURCE]] -= members[0]
    gone = store.layers[layers, c.LAYER_GONE]
    return TeamContents(store.near[slots], store.far[slots], links, marks, sweeps, gone, *names, payloads, mail)


def put_team_contents(buffer: Any, team: int, state: TeamContents, later: float) -> None:  # noqa: ANN401
    """Replace the stored gradients of a team by the result of `team_contents`, `later` [s] after it; as many rows."""
    buffer.clear(team)
    near, far, links, marks = state.near.copy(), state.far.copy(), state.links.copy(), state.marks.copy()
    count = len(near)
    buffer.table.reserve(count)
    codes = np.array([buffer.channel_code(name) for name in state.channels], dtype=np.int64)
    layers = buffer.layers_of(team, codes)
    near[:, c.NEAR_DUE] += later
    far[:, [c.FAR_CLOCK, c.FAR_STAMP]] += later
    moving = links[:, c.LINK_LAYER] % c.LEVELS == c.MOVING
    senders = np.array([*buffer.poses.members(team), *(buffer.sources.code(name) for name in state.sources), -1])
    marks[:, c.MARK_SOURCE] = senders[marks[:, c.MARK_SOURCE]]
    links[moving, c.LINK_CELL] = marks[moving, c.MARK_SOURCE]
    keys = np.array([*(buffer.keys.code(name) for name in state.keys), -1])
    marks[:, c.MARK_KEY] = keys[marks[:, c.MARK_KEY]]
    links[:, c.LINK_LAYER] = layers[links[:, c.LINK_LAYER]]
    record, back = buffer.table.record, marks[:, c.MARK_SERIAL].astype(np.int64)
    order = np.argsort(-back, kind="stable")  # the oldest first
    first = int(record.counters[c.COUNTER_SERIAL]) + 1
    marks[order, c.MARK_SERIAL] = (first + np.arange(count)) % c.SERIALS
    record.counters[c.COUNTER_SERIAL] += count
    record.layers[layers, c.LAYER_GONE] = state.gone
    place_slots(near, far, links, marks, layers, state.sweeps, buffer.table.packed.handle)
    for arrival, messages, tags in state.mail:
        messages, tags = messages.copy(), tags.copy()
        messages[:, [c.MESSAGE_FAR + c.FAR_CLOCK, c.MESSAGE_FAR + c.FAR_STAMP]] += later
        tags[:, [c.TAG_SPACE, c.TAG_SOURCE]] += buffer.poses.members(team)[0]
        tags[:, c.TAG_CHANNEL], tags[:, c.TAG_KEY] = codes[tags[:, c.TAG_CHANNEL]], keys[tags[:, c.TAG_KEY]]
        buffer.mail.add(arrival + later, messages, tags)
    for serial, payload in state.payloads.items():
        buffer.payloads[int(marks[np.flatnonzero(back == serial)[0], c.MARK_SERIAL])] = payload


@lean_kernel
def list_slots(layers: Ints, slots: Ints, sweeps: Ints, store: Handle[Store]) -> None:
    """Fill `slots` (K,) with those of the `layers` (L,), in the order of storing, and `sweeps` (L,)."""
    s = open_store(store)
    count = 0
    for index in range(layers.shape[0]):
        first, slot = count, int(s.layers[layers[index], c.LAYER_HEAD])
        while slot >= 0:
            if slot == s.layers[layers[index], c.LAYER_SWEEP]:
                sweeps[index] = count - first
            slots[count] = slot
            count += 1
            slot = int(s.marks[slot, c.MARK_AFTER])


@lean_kernel
def place_slots(
    near: Floats, far: Floats, links: Links, marks: Links, layers: Ints, sweeps: Ints, store: Written[Store]
) -> None:
    """Store gradients whose columns say where they belong; see `TeamContents`."""
    s = open_store(store)
    within, sweep = 0, 0
    for index in range(near.shape[0]):
        slot = claim_slot(store)
        for column in range(c.NEAR_COLUMNS):
            s.near[slot, column] = near[index, column]
        for column in range(c.FAR_COLUMNS):
            s.far[slot, column] = far[index, column]
        for column in range(c.LINK_COLUMNS):
            s.links[slot, column] = links[index, column]
        for column in range(c.MARK_COLUMNS):
            s.marks[slot, column] = marks[index, column]
        link(slot, store)
        layer = links[index, c.LINK_LAYER]
        if index == 0 or layer != links[index - 1, c.LINK_LAYER]:
            within = 0
            while layers[sweep] != layer:
                sweep += 1
        if sweeps[sweep] == within:
            s.layers[layer, c.LAYER_SWEEP] = slot
        within += 1
