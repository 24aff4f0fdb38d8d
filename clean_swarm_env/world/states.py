"""States of worlds: all that the course of a world depends on, from which this or another world goes on.

The other world may be in another batch and at another time of the clock: its further course has the same bits. A state
is all that classes declare as kept (`selforg.arrays`); `selforg.declared` finds it. `selforg.sealing` makes bytes of a
state.
"""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from clean_swarm_env.config.frames import check_frame
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.clock import Clock
from selforg.arrays import Mark
from selforg.declared import Shared, walk
from selforg.sealing import check_alike


class WorldState(NamedTuple):
    """All that the further course of one world depends on."""

    likeness: bytes
    """What both worlds must have in common, beside the frame of the mission: a mapping, pickled."""
    mission: MissionConfig
    tick: int
    """Tick and time [s] of the clock when the state was made."""
    now: float
    arrays: bytes
    """The world's part of each array, one after the other."""
    things: dict[str, Any]
    """The world's part of lists, buffers and other things that are kept, by path."""


class Slot(NamedTuple):
    """Something that is kept or derived, and where a world's part of an array lies in the bytes of a state."""

    path: str
    owner: Any
    name: str
    mark: Mark
    share: int
    """Entries that belong to a world; 0: one that belongs to all."""
    least: int
    """Bounds of indices, if `limit` is above 0."""
    limit: int
    first: int
    """First byte, and how many there are."""
    size: int


class StreamState(NamedTuple):
    """The state of a random generator."""

    state: dict[str, Any]


class KeptStates:
    """Makes states of the worlds below `root`, and puts them in.

    Args:
        root: holds all that belongs to the worlds.
        mission: that of the batch; a state of a mission with another frame does not fit.
        missions: (W,) those of the worlds.
        clock: that of the worlds.
        alike: what worlds must have in common to go on from each other's states, beside the shapes of what they keep.

    Raises:
        TypeError: at the first use: a class does not declare an array, or one that has no entry for each world or row.

    """

    def __init__(
        self,
        root: object,
        mission: MissionConfig,
        missions: list[MissionConfig],
        clock: Clock,
        alike: Mapping[str, object],
    ) -> None:
        self._root, self._mission, self._missions, self._clock, self._alike = root, mission, missions, clock, alike

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy begins with: it finds its own arrays."""
        return {name: value for name, value in vars(self).items() if name not in {"_kept", "_likeness"}}

    @cached_property
    def _kept(self) -> tuple[list[Slot], list[Slot], dict[str, Shared]]:
        """The arrays, the lists, and whatever else is kept, by path."""
        kept, forgotten = walk(self._root)
        if forgotten:
            raise TypeError(f"{type(self._root).__name__}.{forgotten[0]}: expected a declaration (selforg.arrays)")
        arrays, lists, shared = [], [], {}
        shares, first = {"1": 0, "W": 1}, 0
        for path, (owner, name, field, limit) in sorted(kept.items()):
            if field is None:
                shared[path] = owner
                continue
            share, value = shares.get(field.axes[0], self._mission.rows), getattr(owner, name)
            if share and len(value) != share * len(self._missions):
                raise TypeError(f"{path}: expected W, R or N first in its shape, got {' '.join(field.axes)}")
            least = field.bounds.least if field.bounds else 0
            slot = Slot(path, owner, name, field.mark, share, least, limit, first, 0)
            if isinstance(value, list):
                lists.append(slot)
                continue
            if field.mark.name != "derived":
                slot = slot._replace(size=value[:share].nbytes)
            arrays.append(slot)
            first += slot.size
        return arrays, lists, shared

    @cached_property
    def _likeness(self) -> bytes:
        """What worlds must have in common: `alike`, and type, shape and mark of all that is kept, by path."""
        arrays, lists, shared = self._kept
        kept = {slot.path: slot.mark.name for slot in lists} | dict.fromkeys(shared, "kept")
        for slot in arrays:
            array = getattr(slot.owner, slot.name)
            kept[slot.path] = f"{slot.mark.name}, {array.dtype}, {array.shape[1:]}"
        return pickle.dumps({**self._alike, **kept}, 5)

    def _parts(self, world: int) -> dict[int, slice]:
        """Return which entries belong to a world, by the share of a world."""
        robots = self._mission.rows
        return {0: slice(None), robots: slice(world * robots, (world + 1) * robots), 1: slice(world, world + 1)}

    def get(self, world: int) -> WorldState:
        """Return the state of a world; parts of it belong to the world until they are `sealed`."""
        (arrays, lists, shared), parts = self._kept, self._parts(world)
        content = b"".join([getattr(s.owner, s.name)[parts[s.share]].tobytes() for s in arrays if s.size])
        things = {path: one.part_of(world) for path, one in shared.items()}
        for slot in lists:
            things[slot.path] = [saved(one) for one in getattr(slot.owner, slot.name)[parts[slot.share]]]
        clock, mission = self._clock, self._missions[world]
        return WorldState(self._likeness, mission, clock.tick, clock.now, content, things)

    def check(self, state: WorldState) -> None:
        """Raise ValueError unless a world can go on from a state."""
        check_frame(state.mission, self._mission)
        if state.likeness != self._likeness:
            check_alike(pickle.loads(self._likeness), pickle.loads(state.likeness))
        for slot in self._kept[0]:
            if slot.limit:
                kind = getattr(slot.owner, slot.name).dtype
                found = np.frombuffer(state.arrays, kind, slot.size // kind.itemsize, slot.first)
                if found.size and not (slot.least <= found.min() and found.max() < slot.limit):
                    expected = f"expected indices from {slot.least} to {slot.limit - 1}"
                    raise ValueError(f"state: {slot.path}: {expected}, got {found.min()} to {found.max()}")

    def put(self, world: int, state: WorldState) -> None:
        """Make a world go on from a state that `check` has let pass, and which it then owns."""
        (arrays, lists, shared), parts = self._kept, self._parts(world)
        later, ticks = self._clock.now - state.now, self._clock.tick - state.tick
        for slot in arrays:
            place, mark = getattr(slot.owner, slot.name)[parts[slot.share]], slot.mark
            if not slot.size:
                place[:] = mark.unknown
                continue
            place[:] = np.frombuffer(state.arrays, place.dtype, place.size, slot.first).reshape(place.shape)
            if mark.name == "clocked":
                place[..., mark.columns or slice(None)] += ticks if place.dtype == np.int64 else later
        for slot in lists:
            getattr(slot.owner, slot.name)[parts[slot.share]] = [restored(one) for one in state.things[slot.path]]
        for path, one in shared.items():
            one.put_part(world, state.things[path], later)
        self._missions[world] = state.mission


def saved(thing: object) -> object:
    """Return the kept state of an entry of a list."""
    return StreamState(dict(thing.bit_generator.state)) if isinstance(thing, np.random.Generator) else thing


def restored(thing: object) -> object:
    """Return the entry of which `saved` kept something."""
    if not isinstance(thing, StreamState):
        return thing
    made: Any = np.random.PCG64(0)
    made.state = thing.state
    return np.random.Generator(made)
