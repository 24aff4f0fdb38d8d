"""The tables of a buffer: owned here, changed by compiled code only, doubled when they are full."""

from typing import TypeVar

import numpy as np

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.bundles import Bundle
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store.candidates import MOST_CANDIDATES, STORE_TABLES, Store
from selforg.gradients.store.columns import (
    AFTER,
    AGGREGATION_DISTANCE,
    BEFORE,
    CELL,
    CHANNELS,
    COUNT,
    COUNTERS,
    EXTENT,
    FAR_COLUMNS,
    FREE,
    HEAD,
    HIGH,
    HISTORY,
    LAST_SERIAL,
    LAYER,
    LAYER_COLUMNS,
    LEVELS,
    LINK_COLUMNS,
    MARK_COLUMNS,
    MIN_DIFFUSION,
    NEAR_COLUMNS,
    PER_ROW,
    SERIAL,
    SETTINGS,
    SPACES,
    SWEEP,
    TAIL,
    TIDY_AT,
    USED,
    WHOLE_SECONDS,
)
from selforg.gradients.store.grid import make_grid, rebuild
from selforg.gradients.store.windows import MOST_CELLS
from selforg.space import Space

Table = TypeVar("Table", Floats, Links)

SMALLEST_CAPACITY = 64  # gradients
SMALLEST_MESS = 4096  # gradients: as many fit a fast cache in any order
SECOND_COPY = 1 << 18  # gradients: of more, a second copy of a table would take too much memory


class Tables:
    """Tables for the gradients of `spaces` information spaces, of whole teams or (`per_row`) of single rows.

    Attributes:
        near, far: (capacity, NEAR_COLUMNS) and (capacity, FAR_COLUMNS) float64.
        links, marks: (capacity, LINK_COLUMNS) and (capacity, MARK_COLUMNS) int32.
        layers: (channels * spaces * LEVELS, LAYER_COLUMNS) int32.
        packed: what compiled code takes, see `candidates.Store`; a new tuple whenever a table is replaced.
        bundle: the same as one argument.

    """

    def __init__(self, settings: BufferSettings, space: Space, spaces: int, per_row: bool) -> None:
        self.spaces = spaces
        self.near: Floats = np.empty((SMALLEST_CAPACITY, NEAR_COLUMNS))
        self.far: Floats = np.empty((SMALLEST_CAPACITY, FAR_COLUMNS))
        self.links: Links = np.empty((SMALLEST_CAPACITY, LINK_COLUMNS), dtype=np.int32)
        self.marks: Links = np.empty((SMALLEST_CAPACITY, MARK_COLUMNS), dtype=np.int32)
        self.layers: Links = np.zeros((0, LAYER_COLUMNS), dtype=np.int32)
        self._buckets: Links = np.full(SMALLEST_CAPACITY, -1, dtype=np.int32)
        self._counters: Ints = np.zeros(COUNTERS + MOST_CELLS + 2 * MOST_CANDIDATES, dtype=np.int64)
        self._counters[[FREE, SPACES, PER_ROW]] = -1, spaces, per_row
        self._settings: Floats = np.zeros(SETTINGS + 5 * MOST_CANDIDATES)
        self._settings[[AGGREGATION_DISTANCE, MIN_DIFFUSION]] = settings.aggregation_distance, settings.min_diffusion
        self._settings[[WHOLE_SECONDS, HISTORY]] = settings.whole_seconds, settings.moving_storage_size
        self._settings[EXTENT : EXTENT + 3] = space.padded_extent
        self._grid = make_grid(space.padded_extent, space.dim, settings.smallest_cell)
        self._counters[TIDY_AT] = SMALLEST_MESS
        self._pack()

    @property
    def used(self) -> int:
        """How many gradients are stored; those that evaporated unseen may still be counted."""
        return int(self._counters[USED])

    @property
    def next_serial(self) -> int:
        """Serial number that the next message will get."""
        return int(self._counters[LAST_SERIAL]) + 1

    def serials(self) -> set[int]:
        """Return the serial numbers (modulo SERIALS) of all stored gradients."""
        high = int(self._counters[HIGH])
        return set(self.marks[:high, SERIAL][self.links[:high, LAYER] >= 0].tolist())

    @property
    def nbytes(self) -> int:
        """Memory of the tables [bytes]."""
        return sum(array.nbytes for array in self.packed)

    def add_channel(self) -> None:
        """Make layers for one channel more."""
        more = np.full((self.spaces * LEVELS, LAYER_COLUMNS), -1, dtype=np.int32)
        more[:, COUNT] = 0
        self.layers = np.concatenate([self.layers, more])
        self._counters[CHANNELS] += 1
        self._pack()

    def count(self, channel: int, spaces: Ints) -> int:
        """Return how many gradients of a channel are stored in some spaces (S,)."""
        counts = self.layers[:, COUNT].reshape(-1, self.spaces, LEVELS)
        return int(counts[channel, spaces].sum())

    def reserve(self, more: int) -> None:
        """Make room for `more` gradients, by doubling; called before each storing."""
        needed, capacity = self.used + more, len(self.links)
        while capacity < needed:
            capacity *= 2
        if capacity > len(self.links) or self._counters[LAST_SERIAL] >= self._counters[TIDY_AT]:
            self._move_to(capacity)

    def _move_to(self, capacity: int) -> None:
        """Move to tables of `capacity`, neighbours in space next to each other: a walk then waits for few cache lines.

        Done whenever a quarter as many have come as there were, so at a cost per gradient that hardly grows.
        """
        live = np.flatnonzero(self.links[: int(self._counters[HIGH]), LAYER] >= 0)
        order = live[np.lexsort((self.links[live, CELL], self.links[live, LAYER]))]
        place = np.full(len(self.links) + 1, -1, dtype=np.int32)  # new slot of each old one; the last: of "none"
        place[order] = np.arange(len(order), dtype=np.int32)
        del self.packed, self.bundle  # they hold the old tables, which go before the next are made
        self.near, self.far = moved(self.near, order, capacity), moved(self.far, order, capacity)
        self.links, self.marks = moved(self.links, order, capacity), moved(self.marks, order, capacity)
        for column in (AFTER, BEFORE):
            self.marks[: len(order), column] = place[self.marks[: len(order), column]]
        for column in (HEAD, TAIL, SWEEP):
            self.layers[:, column] = place[self.layers[:, column]]
        self._counters[[FREE, HIGH]] = -1, len(order)
        self._buckets = np.empty(capacity, dtype=np.int32)
        rebuild(self.links, self.marks, self.layers, self._buckets, self._counters)
        self._counters[TIDY_AT] = self._counters[LAST_SERIAL] + max(SMALLEST_MESS, len(order) // 4)
        self._pack()

    def _pack(self) -> None:
        self.packed: Store = (
            self.near, self.links, self.far, self.marks, self.layers, self._buckets, self._grid, self._counters,
            self._settings,
        )  # fmt: skip
        self.bundle: Bundle = STORE_TABLES.bundle(*self.packed)


def moved(old: Table, order: Ints, capacity: int) -> Table:
    """Return a table of `capacity` rows, the first of which are the rows `order` (R,) of `old` (M, C)."""
    if capacity == len(old) and len(order) > SECOND_COPY:
        for column in range(old.shape[1]):
            old[: len(order), column] = old[order, column]
        return old
    new = np.empty((capacity, old.shape[1]), dtype=old.dtype)
    np.take(old, order, axis=0, out=new[: len(order)], mode="clip")  # "raise" would buffer
    return new
