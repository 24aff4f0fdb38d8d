"""Queries: the gradients that rows see in a buffer, as tables for many rows and as gradients for one.

A query evaporates first, and answers with the gradients in *view*: distance <= reach + view distance. If there is none,
the answer is an empty range of the table, an empty list, or a mask that is False.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np

from selforg.arrays import SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.pair import (
    CHOOSE_FARTHEST,
    CHOOSE_LEAST_REACH,
    CHOOSE_MOST_REACH,
    CHOOSE_NEAREST,
    CHOOSE_STRONGEST,
    choose,
    own_of,
)
from selforg.gradients.poses import RowNumbers
from selforg.gradients.store import columns as c
from selforg.gradients.store.columns import PAIR_COLUMNS
from selforg.gradients.store.gathering import gather, look_all_around
from selforg.gradients.store.records import Margins, Poses, Sight, Store, open_poses, open_sight, open_store
from selforg.program import Rows, Step


class PairRoom:
    """A table of pairs that grows, and the channels at which rows look, as one record.

    Attributes:
        pairs: (P, PAIR_COLUMNS) float64.

    """

    def __init__(self, buffer: SoBuffer, pairs: int = 256) -> None:
        self._buffer = buffer
        self._looked: tuple[tuple[str, ...], int] = (), -1  # the channels, and how many the buffer knew then
        self.pairs: Floats = np.empty((pairs, PAIR_COLUMNS))
        self.packed: Packed[Sight] = Packed(Sight(np.zeros(1, dtype=np.int64), -1, self.pairs))

    def sight(self, now: float, channels: tuple[str, ...]) -> Handle[Sight]:
        """Return the table and `channels` (none: all) for a look at `now` [s], as compiled code takes them."""
        buffer = self._buffer
        if buffer.settings.whole_seconds:
            buffer.evaporate(now)
        look = channels, len(buffer.channels)
        if look != self._looked:
            self._looked = look
            self.packed.replace(Sight(self._codes(channels), len(buffer.channels), self.pairs))
        return self.packed.handle

    def _codes(self, channels: tuple[str, ...]) -> Ints:
        """Return 1 if the shared poses are looked at, then the codes of `channels` (none: all).

        Channels are in the order of their names, because the order in which other teams used them first must not
        change a sum.
        """
        buffer, known, names = self._buffer, self._buffer.channels, sorted(set(channels))
        poses = buffer.shared and (not names or buffer.poses.channel in names)
        codes = [known.code(name) for name in names or known.names() if name in known]
        return np.array([int(poses), *codes], dtype=np.int64)

    def look(
        self, kernel: Callable[..., int], now: float, rows: Ints, channels: tuple[str, ...], *records: Packed[Any]
    ) -> None:
        """Call a kernel for `rows` (R,) that look at `channels`, and for those left where one sees too much for it."""
        self.sight(now, channels)
        while left := kernel(now, rows, *(packed.handle for packed in records)):
            rows = rows[-left:]
            self.double()

    def double(self) -> Handle[Sight]:
        """Return the last sight with room for twice as many pairs; those that are there stay."""
        self.pairs = np.concatenate([self.pairs, np.empty_like(self.pairs)])
        self.packed.replace(self.packed.record._replace(pairs=self.pairs))
        return self.packed.handle


EVERYTHING, ATTRACTIVE, REPULSIVE = (True, True, True), (False, False, True), (True, False, False)

SEE_WITHOUT_POSE = 16
"""A bit beside those of `columns`: rows without a pose look too."""

CHOICES: Mapping[str, int] = {
    "nearest_attractive": CHOOSE_NEAREST,
    "farthest_attractive": CHOOSE_FARTHEST,
    "least_reach_attractive": CHOOSE_LEAST_REACH,
    "most_reach_attractive": CHOOSE_MOST_REACH,
    "strongest": CHOOSE_STRONGEST,
}


@dataclass(frozen=True)
class Seen:
    """What rows see: row i's pairs are `pairs[start[i]:start[i + 1]]`.

    start: (R + 1,) int64; pairs: (P, PAIR_COLUMNS) float64, columns PAIR_ of `selforg.gradients.store.columns`.
    """

    start: Ints
    pairs: Floats


@dataclass(frozen=True)
class Filter:
    """What a query looks at: channels (none given: all), static and moving gradients, how far (None: the buffer's)."""

    channels: tuple[str, ...] = ()
    static: bool = True
    moving: bool = True
    view_distance: float | None = None


class Choosing(NamedTuple):
    """A rule by which rows choose one gradient, what they look at, and where the chosen ones are."""

    rule: int  # CHOOSE_
    sight_bits: int  # SEE_
    view_distance: float  # [m]
    offsets: Annotated[Floats, "R D", SCRATCH]  # from the own centre to that of the gradient, 0 without one [m]
    clearance: Annotated[Floats, "R", SCRATCH]  # distance of the centres minus both goal radii, 0 without one [m]
    present: Annotated[Flags, "R", SCRATCH]  # whether there is one


open_choosing = opening(Choosing)


class Queries:
    """The queries of a buffer.

    Example:
        >>> seen = Queries(buffer).gather(now=1.0, rows=[0, 1])
        >>> Queries(buffer).gradients(row=0, now=1.0)

    """

    def __init__(self, buffer: SoBuffer) -> None:
        self._buffer = buffer
        self._room = PairRoom(buffer)

    def gather(
        self,
        now: float,
        rows: RowNumbers | None = None,
        look: Filter = Filter(),
        *,
        signs: tuple[bool, bool, bool] = EVERYTHING,
        own: bool = True,
        histories: bool = False,
        without_pose: bool = False,
    ) -> Seen:
        """Return what `rows` (R,) (None: all) see.

        signs: which attractions, for -1, 0, +1. own: also moving gradients that the row itself spread (never its own
        pose). histories: all stored moving gradients, not the newest per source. without_pose: an infinite view needs
        no own pose.
        """
        buffer = self._buffer
        chosen = buffer.poses.chosen(rows)
        view = buffer.settings.view_distance if look.view_distance is None else look.view_distance
        minus, zero, plus = (view if wanted else -np.inf for wanted in signs)
        see = seen_by(look) | (0 if own else c.SKIP_OWN) | (c.SEE_HISTORY if histories else 0)
        see |= SEE_WITHOUT_POSE if without_pose and np.isinf(view) else 0
        time, margins, sight = float(now), (minus, zero, plus), self._room.sight(now, tuple(look.channels))
        poses, store = buffer.poses.packed.handle, buffer.table.packed.handle
        start: Ints = np.zeros(len(chosen) + 1, dtype=np.int64)
        done = gather_rows(chosen, start, see, margins, time, sight, poses, store)
        while done < len(chosen):
            sight = self._room.double()
            done += gather_rows(chosen[done:], start[done:], see, margins, time, sight, poses, store)
        return Seen(start, self._room.pairs[: start[-1]].copy())

    def choosing(self, stage: int, rows: Rows, rule: str, look: Filter, answers: tuple[Floats, Floats, Flags]) -> Step:
        """Return the step of a program that writes the `answers` of a `Choosing` for `rows`, by a rule of CHOICES."""
        buffer, room, channels = self._buffer, self._room, tuple(look.channels)
        view = buffer.settings.view_distance if look.view_distance is None else look.view_distance
        chosen = Packed(Choosing(choice_named(rule), seen_by(look), float(view), *answers))
        records: tuple[Packed[Any], ...] = (chosen, room.packed, buffer.poses.packed, buffer.table.packed)

        def go_on(now: float, rows: Ints, left: int = 0) -> None:
            room.look(choose_goals, now, rows[-left:], channels, *records)

        in_python = buffer.settings.whole_seconds  # all has to evaporate before each look
        return Step(stage, go_on, rows) if in_python else Step(stage, go_on, rows, choose_goals, records)

    def gradients(
        self, row: int, now: float, look: Filter = Filter(), *, signs: tuple[bool, bool, bool] = EVERYTHING
    ) -> list[Gradient]:
        """Return the gradients that `row` sees.

        An infinite view distance shows all, even without an own pose, unless `signs` leaves some out (B1).
        """
        pairs = self.gather(now, [row], look, signs=signs, without_pose=all(signs)).pairs
        return [self._buffer.gradient_of(pair) for pair in pairs]


def choice_named(rule: str) -> int:
    """Return the number of a rule by its name; KeyError names the known ones."""
    if rule not in CHOICES:
        raise KeyError(f"unknown choice {rule!r}; known: {', '.join(CHOICES)}")
    return CHOICES[rule]


def seen_by(look: Filter) -> int:
    """Return the SEE_ bits of a look."""
    return (c.SEE_STATIC if look.static else 0) | (c.SEE_MOVING if look.moving else 0)


@lean_kernel
def choose_goals(
    now: float,
    rows: Ints,
    choosing: Handle[Choosing],
    sight: Handle[Sight],
    poses: Handle[Poses],
    store: Written[Store],
) -> int:
    """Write what each of `rows` (R,) chooses; a step, see `selforg.program`.

    Returns how many rows are left, the last ones: because channels are new, or if the room for pairs is too short.
    """
    chosen, pairs, p = open_choosing(choosing), open_sight(sight).pairs, open_poses(poses)
    if len(open_store(store).rules) != open_sight(sight).known:
        return len(rows)
    view = chosen.view_distance
    others = view if chosen.rule == CHOOSE_STRONGEST else -np.inf
    for index in range(len(rows)):
        row, best = int(rows[index]), -1
        if p.rows[row, c.ROW_POSES] > 0:
            look = look_all_around(row, now, chosen.sight_bits, (others, others, view), 0, sight, poses)
            found = gather(look, sight, poses, store)
            if found > len(pairs):
                return len(rows) - index
            best = choose(chosen.rule, pairs, found, own_of(row, view, poses))
        chosen.present[row], chosen.clearance[row] = best >= 0, 0.0
        if best >= 0:
            reached = pairs[best, c.PAIR_DISTANCE] - pairs[best, c.PAIR_GOAL_RADIUS]
            chosen.clearance[row] = reached - p.own[row, 0, c.GOAL_RADIUS]
        for axis in range(chosen.offsets.shape[1]):
            chosen.offsets[row, axis] = pairs[best, c.PAIR_DX + axis] if best >= 0 else 0.0
    return 0


@lean_kernel
def gather_rows(
    rows: Ints,
    start: Ints,
    see: int,
    margins: Margins,
    now: float,
    sight: Handle[Sight],
    poses: Handle[Poses],
    store: Written[Store],
) -> int:
    """Write the pairs of `rows` (R,) from start[0] on, row after row, and where each row's end into `start` (R + 1,).

    Returns how many rows are done, fewer than R if there is no room for the pairs of the next one. A row without a pose
    sees nothing, unless `see` has SEE_WITHOUT_POSE.
    """
    known, room = open_poses(poses).rows, len(open_sight(sight).pairs)
    for index in range(len(rows)):
        row, begin = int(rows[index]), int(start[index])
        start[index + 1] = begin
        if known[row, c.ROW_POSES] == 0 and see & SEE_WITHOUT_POSE == 0:
            continue
        end = gather(look_all_around(row, now, see, margins, begin, sight, poses), sight, poses, store)
        if end > room:
            return index
        start[index + 1] = end
    return len(rows)
