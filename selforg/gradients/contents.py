"""The contents of a buffer, and the part of one team: taken out, and put into another buffer for another team.

The order of storing stays, so that the team finds the same gradients in the same order, wherever they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Words, Written
from selforg.gradients.delivery import Delivery, Mail, Post
from selforg.gradients.poses import OwnPoses
from selforg.gradients.rows import Codes
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store import columns as c
from selforg.gradients.store.linking import claim_slot, link
from selforg.gradients.store.records import Store, open_store
from selforg.gradients.store.storing import clear_space
from selforg.gradients.store.tables import Tables
from selforg.space import Space


class TeamContents(NamedTuple):
    """The gradients of one team, K of them, layer by layer in the order of storing."""

    near: Floats  # (K, NEAR_COLUMNS)
    far: Floats  # (K, FAR_COLUMNS)
    links: Links  # (K, LINK_COLUMNS); LINK_LAYER counts the layers of the team
    marks: Links  # (K, MARK_COLUMNS); MARK_SERIAL counts back from the last message of the buffer, MARK_SOURCE first
    # the rows of the team, then `sources`
    sweeps: Ints  # (layers of the team,) which gradient is checked next, -1: the first
    channels: tuple[str, ...]  # by their numbers
    keys: tuple[str, ...]  # names of values, by their numbers
    sources: tuple[str, ...]  # names of senders that are not rows, by their numbers
    payloads: dict[int, Any]  # by MARK_SERIAL
    mail: list[Post]  # under way; rows count from the team's first


class Contents:
    """The gradients of all teams, in one table, and all that tells what their numbers mean.

    Attributes:
        shared: whether the rows of a team share one content; otherwise each row has its own.
        mail: messages under way.
        channels, sources, keys: names by their numbers.
        payloads: by serial number.

    """

    def __init__(self, settings: BufferSettings, space: Space, poses: OwnPoses, delivery: Delivery) -> None:
        if space is not poses.space:
            raise ValueError("SoBuffer: the poses live in another space object than the buffer")
        self.settings, self.space, self.poses, self.delivery = settings, space, poses, delivery
        self.shared = delivery.ideal
        self.mail = Mail()
        self.channels, self.sources, self.keys = Codes(), Codes(poses.rows, poses.names), Codes()
        self.payloads: dict[int, Mapping[str, Any]] = {}
        self.table = Tables(settings, space, poses.team_count if self.shared else poses.rows, not self.shared)

    def clear(self, team: int) -> None:
        """Delete everything that one team has stored, and its messages under way."""
        self._clear_spaces(self._spaces(team))

    def channel_code(self, channel: str) -> int:
        """Return the number of `channel`, a new one if it was never used."""
        if channel not in self.channels:
            self.table.add_channel(self.settings.rule_of(channel))
        return self.channels.code(channel)

    def part_of(self, team: int) -> TeamContents:
        """Return the stored gradients of a team, with its messages under way."""
        store, channels = self.table.record, self.channels.numbered()
        layers = self._layers(team, np.arange(len(channels)))
        slots = np.zeros(int(store.layers[layers, c.LAYER_COUNT].sum()), dtype=np.int64)
        sweeps = np.full(len(layers), -1)
        list_slots(layers, slots, sweeps, self.table.packed.words)
        links, marks = store.links[slots], store.marks[slots]
        links[:, c.LINK_LAYER] = np.repeat(np.arange(len(layers)), store.layers[layers, c.LAYER_COUNT])
        senders, members, rows = marks[:, c.MARK_SOURCE], self.poses.members(team), self.poses.rows
        own = np.where(senders < rows, senders - members[0], senders - rows + len(members))
        senders[:] = np.where(senders < 0, -1, own)
        serials, last = marks[:, c.MARK_SERIAL], int(store.counters[c.COUNTER_SERIAL])
        payloads = {}
        if self.payloads:
            found = {serial: self.payloads[serial] for serial in serials.tolist() if serial in self.payloads}
            payloads = {(last - serial) % c.SERIALS: payload for serial, payload in found.items()}
        serials[:] = (last - serials.astype(np.int64)) % c.SERIALS
        names = channels, self.keys.numbered(), self.sources.numbered()
        mail = self.mail.to(members)
        for _, _, tags in mail:
            tags[:, [c.TAG_SPACE, c.TAG_SOURCE]] -= members[0]
        return TeamContents(store.near[slots], store.far[slots], links, marks, sweeps, *names, payloads, mail)

    def put_part(self, team: int, state: TeamContents, later: float) -> None:
        """Replace the stored gradients of a team by the result of `part_of`, `later` [s] after it; as many rows."""
        self.clear(team)
        near, far, links, marks = state.near.copy(), state.far.copy(), state.links.copy(), state.marks.copy()
        count = len(near)
        self.table.reserve(count)
        codes = np.array([self.channel_code(name) for name in state.channels], dtype=np.int64)
        layers = self._layers(team, codes)
        near[:, c.NEAR_DUE] += later
        far[:, [c.FAR_CLOCK, c.FAR_STAMP]] += later
        moving = links[:, c.LINK_LAYER] % c.LEVELS == c.MOVING
        senders = np.array([*self.poses.members(team), *(self.sources.code(name) for name in state.sources), -1])
        marks[:, c.MARK_SOURCE] = senders[marks[:, c.MARK_SOURCE]]
        links[moving, c.LINK_CELL] = marks[moving, c.MARK_SOURCE]
        keys = np.array([*(self.keys.code(name) for name in state.keys), -1])
        marks[:, c.MARK_KEY] = keys[marks[:, c.MARK_KEY]]
        links[:, c.LINK_LAYER] = layers[links[:, c.LINK_LAYER]]
        record, back = self.table.record, marks[:, c.MARK_SERIAL].astype(np.int64)
        order = np.argsort(-back, kind="stable")  # the oldest first
        first = int(record.counters[c.COUNTER_SERIAL]) + 1
        marks[order, c.MARK_SERIAL] = (first + np.arange(count)) % c.SERIALS
        record.counters[c.COUNTER_SERIAL] += count
        place_slots(near, far, links, marks, layers, state.sweeps, self.table.packed.words)
        for arrival, messages, tags in state.mail:
            messages, tags = messages.copy(), tags.copy()
            messages[:, [c.MESSAGE_FAR + c.FAR_CLOCK, c.MESSAGE_FAR + c.FAR_STAMP]] += later
            tags[:, [c.TAG_SPACE, c.TAG_SOURCE]] += self.poses.members(team)[0]
            tags[:, c.TAG_CHANNEL], tags[:, c.TAG_KEY] = codes[tags[:, c.TAG_CHANNEL]], keys[tags[:, c.TAG_KEY]]
            self.mail.add(arrival + later, messages, tags)
        for serial, payload in state.payloads.items():
            self.payloads[int(marks[np.flatnonzero(back == serial)[0], c.MARK_SERIAL])] = payload

    def _clear_spaces(self, spaces: Ints) -> None:
        for space in spaces.tolist():
            clear_space(space, self.table.packed.words)
        self.mail.forget(spaces)

    def _spaces(self, team: int) -> Ints:
        """Return the information spaces of a team."""
        self._check_teams(team)
        return np.array([team]) if self.shared else self.poses.members(team)

    def _check_teams(self, teams: npt.ArrayLike) -> Ints:
        codes: Ints = np.asarray(teams, dtype=np.int64)
        if ((codes < 0) | (codes >= self.poses.team_count)).any():
            raise ValueError(f"SoBuffer: teams must lie in 0..{self.poses.team_count - 1}, got {teams!r}")
        return codes

    def _layers(self, team: int, channels: Ints) -> Ints:
        """Return the layers of a team on `channels`, channel by channel."""
        spaces = channels[:, None] * self.table.spaces + self._spaces(team)
        return (spaces.reshape(-1, 1) * c.LEVELS + np.arange(c.LEVELS)).reshape(-1)


@lean_kernel
def list_slots(layers: Ints, slots: Ints, sweeps: Ints, store: Words[Store]) -> None:
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
