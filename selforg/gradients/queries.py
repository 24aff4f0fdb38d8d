"""Queries: what rows see in a buffer, as tables for many rows and as gradients for one.

All are answered after evaporation and within *view*: distance <= reach + view distance. "Nothing" is an empty range of
the table, an empty list, or a mask that is False.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.bundles import Bundle
from selforg.compiler.decorators import lean_kernel
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.choosing import FARTHEST, LEAST_REACH, MOST_REACH, NEAREST, STRONGEST, choose_rows
from selforg.gradients.gradient import Gradient
from selforg.gradients.reading import gradient_of
from selforg.gradients.store.candidates import Margins
from selforg.gradients.store.columns import GOAL, PAIR_COLUMNS, POSES, SEE_HISTORY, SEE_MOVING, SEE_STATIC, SKIP_OWN
from selforg.gradients.store.gathering import gather
from selforg.gradients.store.pose_cells import poses_of
from selforg.mechanisms.kernels.moving import keep_ahead

Rows: TypeAlias = npt.NDArray[np.integer] | Iterable[int]

EVERYTHING, ATTRACTIVE, REPULSIVE = (True, True, True), (False, False, True), (True, False, False)

CHOICES: Mapping[str, int] = {
    "nearest_attractive": NEAREST,
    "farthest_attractive": FARTHEST,
    "least_reach_attractive": LEAST_REACH,
    "most_reach_attractive": MOST_REACH,
    "strongest": STRONGEST,
}


@dataclass(frozen=True)
class Seen:
    """What rows see: row i's pairs are `pairs[start[i]:start[i + 1]]`.

    start: (R + 1,) int64; pairs: (P, PAIR_COLUMNS) float64, columns in `selforg.gradients.store.columns` (DX .. SLOT).
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


class Queries:
    """The queries of a buffer.

    Example:
        >>> seen = Queries(buffer).see(now=1.0, rows=[0, 1])
        >>> chosen, found = Queries(buffer).choose("nearest_attractive", now=1.0)
        >>> Queries(buffer).gradients(row=0, now=1.0)

    """

    def __init__(self, buffer: SoBuffer) -> None:
        self._buffer = buffer
        self._pairs: Floats = np.empty((256, PAIR_COLUMNS))

    def see(
        self,
        now: float,
        rows: Rows | None = None,
        look: Filter = Filter(),
        *,
        signs: tuple[bool, bool, bool] = EVERYTHING,
        own: bool = True,
        histories: bool = False,
        angles: tuple[float, float] | None = None,
        without_pose: bool = False,
    ) -> Seen:
        """Return what `rows` (R,) (None: all) see.

        signs: which attractions, for -1, 0, +1. own: also moving gradients that the row itself spread (never its own
        pose). histories: all stored moving gradients, not the newest per source. angles: view angles [rad] in the
        x-y and the y-z plane to either side of the heading. without_pose: an infinite view needs no own pose.
        """
        buffer = self._buffer
        if buffer.settings.whole_seconds:
            buffer.evaporate(now)
        chosen: Ints = np.arange(buffer.poses.rows) if rows is None else np.ascontiguousarray(rows, dtype=np.int64)
        view = buffer.settings.view_distance if look.view_distance is None else look.view_distance
        minus, zero, plus = (view if wanted else -np.inf for wanted in signs)
        see = (SEE_STATIC if look.static else 0) | (SEE_MOVING if look.moving else 0)
        see |= (0 if own else SKIP_OWN) | (SEE_HISTORY if histories else 0)
        channels = buffer.channel_table(look.channels)
        start: Ints = np.zeros(len(chosen) + 1, dtype=np.int64)
        xy, yz = (np.inf, np.inf) if angles is None else angles
        done = 0
        while done < len(chosen):
            done = see_rows(
                done, chosen, (minus, zero, plus), see, float(now), channels, xy, yz, without_pose,
                buffer.poses.bundle, buffer.tables, self._pairs, start,
            )  # fmt: skip
            if done < len(chosen):
                self._pairs = np.concatenate([self._pairs, np.empty_like(self._pairs)])
        return Seen(start, self._pairs[: start[-1]].copy())

    def choose(
        self,
        rule: str,
        now: float,
        rows: Rows | None = None,
        look: Filter = Filter(),
    ) -> tuple[Floats, Flags]:
        """Return for each of `rows` the pair (R, PAIR_COLUMNS) that `rule` chooses, and whether there is one (R,).

        rule: nearest_attractive, farthest_attractive, least_reach_attractive, most_reach_attractive or strongest.
        """
        if rule not in CHOICES:
            raise KeyError(f"unknown choice {rule!r}; known: {', '.join(CHOICES)}")
        chosen: Ints = (
            np.arange(self._buffer.poses.rows) if rows is None else np.ascontiguousarray(rows, dtype=np.int64)
        )
        seen = self.see(now, chosen, look, signs=EVERYTHING if rule == "strongest" else ATTRACTIVE)
        pairs, found = np.empty((len(chosen), PAIR_COLUMNS)), np.empty(len(chosen), dtype=np.bool_)
        poses = self._buffer.poses
        goals, known = poses.own[chosen, 0, GOAL], poses.known[chosen]
        choose_rows(CHOICES[rule], seen.start, seen.pairs, goals, known, pairs, found)
        return pairs, found

    def gradients(
        self,
        row: int,
        now: float,
        look: Filter = Filter(),
        *,
        signs: tuple[bool, bool, bool] = EVERYTHING,
    ) -> list[Gradient]:
        """Return the gradients that `row` sees. An infinite view distance shows all, even without an own pose."""
        return self._objects(self.see(now, [row], look, signs=signs, without_pose=True).pairs)

    def neighbours(self, row: int, now: float, look: Filter = Filter()) -> list[Gradient]:
        """Return the newest moving gradient in view of every other robot, per channel and source."""
        look = Filter(look.channels, False, True, look.view_distance)
        return self._objects(self.see(now, [row], look, own=False).pairs)

    def neighbour_histories(
        self,
        row: int,
        now: float,
        look: Filter = Filter(),
        *,
        own: bool = False,
    ) -> list[list[Gradient]]:
        """Return the stored moving gradients in view, one list per channel and source, the oldest first.

        own: also those the row itself spread on other channels than its poses'.
        """
        look = Filter(look.channels, False, True, look.view_distance)
        found = self._objects(self.see(now, [row], look, own=own, histories=True).pairs)
        histories: dict[tuple[str, int | str], list[Gradient]] = {}
        for gradient in sorted(found, key=lambda g: g.stamp):
            histories.setdefault((gradient.channel, gradient.source), []).append(gradient)
        return list(histories.values())

    def static_ahead(
        self,
        row: int,
        now: float,
        angle_xy: float,
        angle_yz: float = np.inf,
        look: Filter = Filter(),
    ) -> list[Gradient]:
        """Return the static gradients in view within the view angles [rad] to either side of the heading."""
        look = Filter(look.channels, True, False, look.view_distance)
        return self._objects(self.see(now, [row], look, angles=(angle_xy, angle_yz)).pairs)

    def chosen(self, rule: str, row: int, now: float, look: Filter = Filter()) -> list[Gradient]:
        """Return the gradient that `rule` chooses for `row`, in a list that is empty if there is none."""
        pairs, found = self.choose(rule, now, [row], look)
        return self._objects(pairs[found])

    def _objects(self, pairs: Floats) -> list[Gradient]:
        return [gradient_of(self._buffer, pair) for pair in pairs]


@lean_kernel
def see_rows(
    begin: int, rows: Ints, margins: Margins, see: int, now: float, channels: Ints, angle_xy: float, angle_yz: float,
    without_pose: bool, poses: Bundle, store: Bundle, pairs: Floats, start: Ints,
) -> int:  # fmt: skip
    """Write the pairs of rows[begin:] (R,) one after the other and where each row's end in `start` (R + 1,).

    Returns how many rows are done, fewer than R if `pairs` is too short for the next one. A row without a pose sees
    nothing, unless it may do `without_pose` and the view is infinite.
    """
    own, known, _, _, _, _, _, _, _ = poses_of(poses)
    everything = without_pose and np.isinf(max(margins[0], margins[1], margins[2]))
    for index in range(begin, len(rows)):
        row, here = int(rows[index]), int(start[index])
        start[index + 1] = here
        if known[row, POSES] == 0 and not everything:
            continue
        mine = pairs[here:]
        found = gather(row, margins, see, len(mine) + 1, now, channels, poses, store, mine)
        if found > len(mine):
            return index
        if angle_xy < np.inf or angle_yz < np.inf:
            found = keep_ahead(own, row, mine, found, angle_xy, angle_yz)
        start[index + 1] = here + found
    return len(rows)
