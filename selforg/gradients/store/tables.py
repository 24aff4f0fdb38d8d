"""The tables of a buffer: owned here, changed by compiled code only, doubled when they are full."""

from typing import TypeVar

import numpy as np

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.records import Packed
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store import columns as c
from selforg.gradients.store.linking import make_levels, rebuild
from selforg.gradients.store.records import MOST_CANDIDATES, Store
from selforg.grid import MOST_CELLS
from selforg.space import Space

Table = TypeVar("Table", Floats, Links)

SMALLEST_CAPACITY = 64  # gradients
SMALLEST_UNSORTED = 4096  # gradients: as many fit a fast cache in any order
SECOND_COPY = 1 << 18  # gradients: of more, a second copy of a table would take too much memory


class Tables:
    """Tables for the gradients of `spaces` information spaces, of whole teams or (`per_row`) of single rows.

    Attributes:
        spaces: number of information spaces.
        packed: the tables as compiled code takes them; the record is another whenever a table is replaced.

    """

    packed: Packed[Store]

    def __init__(self, settings: BufferSettings, space: Space, spaces: int, per_row: bool) -> None:
        self.spaces = spaces
        bounds, cells = make_levels(space.padded_extent, space.dim, settings.smallest_cell)
        counters = np.zeros(c.COUNTERS, dtype=np.int64)
        counters[[c.COUNTER_FREE, c.COUNTER_TIDY_AT]] = -1, SMALLEST_UNSORTED
        self.packed = Packed(
            Store(
                near=np.empty((SMALLEST_CAPACITY, c.NEAR_COLUMNS)),
                links=np.empty((SMALLEST_CAPACITY, c.LINK_COLUMNS), dtype=np.int32),
                far=np.empty((SMALLEST_CAPACITY, c.FAR_COLUMNS)),
                marks=np.empty((SMALLEST_CAPACITY, c.MARK_COLUMNS), dtype=np.int32),
                layers=np.zeros((0, c.LAYER_COLUMNS), dtype=np.int32),
                buckets=np.full(SMALLEST_CAPACITY, -1, dtype=np.int32),
                rules=np.zeros(0, dtype=np.int64),
                bounds=bounds,
                cells=cells,
                counters=counters,
                extent=space.padded_extent,
                window=np.zeros(MOST_CELLS, dtype=np.int64),
                candidates=np.zeros(MOST_CANDIDATES, dtype=np.int64),
                chosen=np.zeros(MOST_CANDIDATES, dtype=np.int64),
                offsets_x=np.zeros(MOST_CANDIDATES),
                offsets_y=np.zeros(MOST_CANDIDATES),
                offsets_z=np.zeros(MOST_CANDIDATES),
                reaches=np.zeros(MOST_CANDIDATES),
                distances=np.zeros(MOST_CANDIDATES),
                spaces=spaces,
                per_row=int(per_row),
                aggregation_distance=settings.aggregation_distance,
                min_diffusion=settings.min_diffusion,
                whole_seconds=int(settings.whole_seconds),
                history=settings.moving_storage_size,
                hidden=int(settings.hidden),
            )
        )

    @property
    def record(self) -> Store:
        """The tables by name; each may be replaced when something is stored."""
        return self.packed.record

    @property
    def used(self) -> int:
        """How many gradients are stored; those that evaporated unseen may still be counted."""
        return int(self.record.counters[c.COUNTER_USED])

    def serials(self) -> set[int]:
        """Return the serial numbers (modulo SERIALS) of all stored gradients."""
        high = int(self.record.counters[c.COUNTER_HIGH])
        stored = self.record.links[:high, c.LINK_LAYER] >= 0
        return set(self.record.marks[:high, c.MARK_SERIAL][stored].tolist())

    def add_channel(self, rule: int) -> None:
        """Make layers for one channel more, which aggregates by `rule` (AGGREGATE_)."""
        more = np.full((self.spaces * c.LEVELS, c.LAYER_COLUMNS), -1, dtype=np.int32)
        more[:, [c.LAYER_COUNT, c.LAYER_GONE]] = 0
        layers = np.concatenate([self.record.layers, more])
        self.packed.replace(self.record._replace(layers=layers, rules=np.append(self.record.rules, rule)))

    def count(self, channel: int, spaces: Ints) -> int:
        """Return how many gradients of a channel are stored in some spaces (S,)."""
        counts = self.record.layers[:, c.LAYER_COUNT].reshape(-1, self.spaces, c.LEVELS)
        return int(counts[channel, spaces].sum())

    def reserve(self, more: int) -> None:
        """Make room for `more` gradients, by doubling; called before each storing."""
        needed, capacity, counters = self.used + more, len(self.record.links), self.record.counters
        while capacity < needed:
            capacity *= 2
        if capacity > len(self.record.links) or counters[c.COUNTER_SERIAL] >= counters[c.COUNTER_TIDY_AT]:
            self._move_to(capacity)

    def _move_to(self, capacity: int) -> None:
        """Move to tables of `capacity` with neighbours in space next to each other, which walks read faster.

        This is done when new gradients are a quarter of the stored ones, so that the cost per gradient hardly grows.
        """
        tables, layers, counters = self.record._asdict(), self.record.layers, self.record.counters
        links = tables["links"]
        live = np.flatnonzero(links[: int(counters[c.COUNTER_HIGH]), c.LINK_LAYER] >= 0)
        order = live[np.lexsort((links[live, c.LINK_CELL], links[live, c.LINK_LAYER]))]
        place = np.full(len(links) + 1, -1, dtype=np.int32)  # new slot of each old one; the last: of "none"
        place[order] = np.arange(len(order), dtype=np.int32)
        del links
        for name in ("near", "far", "links", "marks"):
            tables[name] = moved(tables[name], order, capacity)
            self.packed.replace(self.record._replace(**{name: tables[name]}))  # frees the old table before the next one
        marks = tables["marks"]
        for column in (c.MARK_AFTER, c.MARK_BEFORE):
            marks[: len(order), column] = place[marks[: len(order), column]]
        for column in (c.LAYER_HEAD, c.LAYER_TAIL, c.LAYER_SWEEP):
            layers[:, column] = place[layers[:, column]]
        counters[[c.COUNTER_FREE, c.COUNTER_HIGH]] = -1, len(order)
        counters[c.COUNTER_TIDY_AT] = counters[c.COUNTER_SERIAL] + max(SMALLEST_UNSORTED, len(order) // 4)
        tables["buckets"] = np.empty(capacity, dtype=np.int32)
        self.packed.replace(Store(**tables))
        rebuild(self.packed.handle)


def moved(old: Table, order: Ints, capacity: int) -> Table:
    """Return a table of `capacity` rows, the first of which are the rows `order` (R,) of `old` (M, C)."""
    if capacity == len(old) and len(order) > SECOND_COPY:
        for column in range(old.shape[1]):
            old[: len(order), column] = old[order, column]
        return old
    new = np.empty((capacity, old.shape[1]), dtype=old.dtype)
    np.take(old, order, axis=0, out=new[: len(order)], mode="clip")  # "raise" would buffer
    return new
