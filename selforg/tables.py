"""The tables of a buffer: owned here, changed by compiled code only, doubled when they are full."""

import numpy as np

from selforg.arrays import Floats, Ints, Links
from selforg.cells import make_grid, rebuild
from selforg.columns import (
    AFTER,
    AGGREGATION_DISTANCE,
    BEFORE,
    CELL,
    CHANNELS,
    COUNT,
    COUNTERS,
    FREE,
    GRADIENT_COLUMNS,
    HEAD,
    HIGH,
    HISTORY,
    LAST_SERIAL,
    LAYER,
    LAYER_COLUMNS,
    LEVELS,
    LINK_COLUMNS,
    MIN_DIFFUSION,
    PER_ROW,
    SERIAL,
    SETTINGS,
    SPACES,
    SWEEP,
    TAIL,
    USED,
    WHOLE_SECONDS,
)
from selforg.gathering import Store
from selforg.settings import BufferSettings
from selforg.space import Space
from selforg.windows import MOST_CELLS

SMALLEST_CAPACITY = 64  # gradients
SMALLEST_MESS = 4096  # gradients: as many fit a fast cache in any order
LARGEST_MESS = 1 << 18  # gradients: beyond, a second copy of the tables would take too much memory


class Tables:
    """Tables for the gradients of `spaces` information spaces, of whole teams or (`per_row`) of single rows.

    Attributes:
        numbers: (capacity, GRADIENT_COLUMNS) float64.
        links: (capacity, LINK_COLUMNS) int32.
        layers: (channels * spaces * LEVELS, LAYER_COLUMNS) int32.
        packed: what compiled code takes, see `selforg.gathering.Store`; a new tuple whenever a table is replaced.

    """

    def __init__(self, settings: BufferSettings, space: Space, spaces: int, per_row: bool) -> None:
        self.spaces = spaces
        self.numbers: Floats = np.zeros((SMALLEST_CAPACITY, GRADIENT_COLUMNS))
        self.links: Links = np.full((SMALLEST_CAPACITY, LINK_COLUMNS), -1, dtype=np.int32)
        self.layers: Links = np.zeros((0, LAYER_COLUMNS), dtype=np.int32)
        self._buckets: Links = np.full(SMALLEST_CAPACITY, -1, dtype=np.int32)
        self._counters: Ints = np.zeros(COUNTERS, dtype=np.int64)
        self._counters[[FREE, SPACES, PER_ROW]] = -1, spaces, per_row
        self._settings: Floats = np.zeros(SETTINGS)
        self._settings[[AGGREGATION_DISTANCE, MIN_DIFFUSION]] = settings.aggregation_distance, settings.min_diffusion
        self._settings[[WHOLE_SECONDS, HISTORY]] = settings.whole_seconds, settings.moving_storage_size
        self._grid = make_grid(space.padded_extent, space.dim, settings.smallest_cell)
        self._window: Ints = np.zeros(MOST_CELLS, dtype=np.int64)
        self._extent = space.padded_extent
        self._tidy_at = SMALLEST_MESS  # serial number from which on neighbours are moved together again
        self.packed: Store = self._pack()

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
        used = self.links[: int(self._counters[HIGH])]
        return set(used[used[:, LAYER] >= 0, SERIAL].tolist())

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
        self.packed = self._pack()

    def count(self, channel: int, spaces: Ints) -> int:
        """Return how many gradients of a channel are stored in some spaces (S,)."""
        counts = self.layers[:, COUNT].reshape(-1, self.spaces, LEVELS)
        return int(counts[channel, spaces].sum())

    def reserve(self, more: int) -> None:
        """Make room for `more` gradients, by doubling; called before each storing."""
        needed, capacity = self.used + more, len(self.links)
        while capacity < needed:
            capacity *= 2
        untidy = self._counters[LAST_SERIAL] >= self._tidy_at and capacity <= LARGEST_MESS
        if capacity > len(self.links) or untidy:
            self._move_to(capacity)

    def _move_to(self, capacity: int) -> None:
        """Move to tables of `capacity`, neighbours in space next to each other: a walk then waits for few cache lines.

        Done whenever a quarter as many have come as there were, so at a cost per gradient that hardly grows.
        """
        live = np.flatnonzero(self.links[: int(self._counters[HIGH]), LAYER] >= 0)
        order = live[np.lexsort((self.links[live, CELL], self.links[live, LAYER]))]
        place = np.full(len(self.links) + 1, -1, dtype=np.int32)  # new slot of each old one; the last: of "none"
        place[order] = np.arange(len(order), dtype=np.int32)
        del self.packed  # it holds the old tables, which go before the next are made
        numbers = np.empty((capacity, GRADIENT_COLUMNS))
        np.take(self.numbers, order, axis=0, out=numbers[: len(order)], mode="clip")  # "raise" would buffer
        self.numbers = numbers
        links = np.empty((capacity, LINK_COLUMNS), dtype=np.int32)
        np.take(self.links, order, axis=0, out=links[: len(order)], mode="clip")
        for column in (AFTER, BEFORE):
            links[: len(order), column] = place[links[: len(order), column]]
        for column in (HEAD, TAIL, SWEEP):
            self.layers[:, column] = place[self.layers[:, column]]
        self.links = links
        self._counters[[FREE, HIGH]] = -1, len(order)
        self._buckets = np.empty(capacity, dtype=np.int32)
        rebuild(self.links, self.layers, self._buckets, self._counters)
        self._tidy_at = self._counters[LAST_SERIAL] + max(SMALLEST_MESS, len(order) // 4)
        self.packed = self._pack()

    def _pack(self) -> Store:
        return (
            self.numbers, self.links, self.layers, self._buckets, self._grid, self._counters, self._settings,
            self._window, self._extent,
        )  # fmt: skip
