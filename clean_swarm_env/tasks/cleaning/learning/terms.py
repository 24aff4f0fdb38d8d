"""Terms about the robot's task: garbage, cargo, phase, stations, and where robots picked garbage lately."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np

from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.term import TERMS, Observed, Term, TermGroup
from clean_swarm_env.tasks.cleaning.garbage import NOTHING
from clean_swarm_env.tasks.cleaning.learning.around import (
    PATROL,
    PHASES,
    cleaning_in,
    find_items,
    find_stations,
    write_way,
)
from clean_swarm_env.tasks.cleaning.records import FloorRecord, open_floor
from selforg.arrays import READ, Flags, Floats, Ints
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Handle, Packed
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c
from selforg.space import Torus


class ItemsWriter:
    """Finds what items and stations are around the robots, and the phases of robots; writes the terms about them."""

    _first: Annotated[Ints, "TERMS", READ]  # first component of each term, -1: not chosen

    def __init__(self, observed: Observed, config: ObservationConfig, first: Ints) -> None:
        chosen = ", ".join(term.name for term in config.terms or () if term.name in ITEM_TERMS.names)
        self._floor: Packed[FloorRecord] = cleaning_in(observed, chosen).site.packed
        self._near, self._first = config.station_range, first

    def write(self, worlds: Ints, rows: Ints, seen: Floats) -> None:
        """Write the terms of `rows` (P,), robots at work in `worlds` (C,), into `seen` (R, F)."""
        self._floor.record.phases.reshape(len(self._floor.record.stage), -1)[worlds] = PATROL
        write_items(self._floor.handle, rows, self._near, self._first, seen)


ITEM_TERMS: TermGroup[FloorRecord] = TermGroup(ItemsWriter)
"""Compiled terms about items, cargo and stations."""


@inlined
def copy_way(floor: FloorRecord, row: int, kind: int, out: Floats) -> None:
    """Copy the way of a row to the nearest station of a kind to the first places of `out`."""
    way = floor.station_ways[row, kind]
    out[0], out[1], out[2] = way[0], way[1], way[2]


@ITEM_TERMS.term("garbage", "garbage_seen", "garbage_distance", "garbage_ahead", "garbage_left")
def write_garbage(floor: FloorRecord, row: int, out: Floats) -> None:
    """The nearest item: whether one lies within sight, and the way to it by the range of sight."""
    out[1] = 1.0
    if floor.in_sight[row] >= 0:
        out[0] = 1.0
        place = floor.items[row // (floor.robots.shape[0] // floor.stage.shape[0]), floor.in_sight[row]]
        write_way(floor, row, place, floor.sight[row], out[1:])


@ITEM_TERMS.term("cargo", "carrying", "recycled")
def write_cargo(floor: FloorRecord, row: int, out: Floats) -> None:
    """Whether the robot carries something, and whether that has been recycled."""
    out[0], out[1] = floor.cargo[row] != NOTHING, floor.recycled[row] == 1


@ITEM_TERMS.term("phase", *(f"phase_{phase}" for phase in PHASES))
def write_phase(floor: FloorRecord, row: int, out: Floats) -> None:
    """One flag: nothing in sight, an item in sight, on the way to recycling, on the way to the dump."""
    out[floor.phases[row]] = 1.0


@ITEM_TERMS.term("situation", "free_far", "free_near", "carrying_far", "carrying_near")
def write_situation(floor: FloorRecord, row: int, out: Floats) -> None:
    """One flag: without or with cargo, far from all stations or within `station_range` of one."""
    near = max(floor.nearness[row, 0], floor.nearness[row, 1]) >= 0.0
    out[2 * (floor.cargo[row] != NOTHING) + near] = 1.0


@ITEM_TERMS.term("recycling", "recycling_distance", "recycling_ahead", "recycling_left")
def write_recycling(floor: FloorRecord, row: int, out: Floats) -> None:
    """The way to the nearest recycling station, by half the torus' diagonal."""
    copy_way(floor, row, 0, out)


@ITEM_TERMS.term("dump", "dump_distance", "dump_ahead", "dump_left")
def write_dump(floor: FloorRecord, row: int, out: Floats) -> None:
    """The way to the nearest dump, by half the torus' diagonal."""
    copy_way(floor, row, 1, out)


@ITEM_TERMS.term("nearness", "recycling_near", "dump_near")
def write_nearness(floor: FloorRecord, row: int, out: Floats) -> None:
    """How near the nearest stations are: 1 at a station, 0 from `station_range` on."""
    for station in range(2):
        out[station] = max(floor.nearness[row, station], 0.0)


@ITEM_TERMS.term("target", "target_distance", "target_ahead", "target_left")
def write_target(floor: FloorRecord, row: int, out: Floats) -> None:
    """The way to the nearest station that the cargo has to go to, by half the torus' diagonal."""
    out[0] = 1.0
    if floor.cargo[row] != NOTHING:
        copy_way(floor, row, 1 if floor.recycled[row] == 1 else 0, out)


write_item_terms = ITEM_TERMS.write_terms


@lean_kernel
def write_items(floor: Handle[FloorRecord], rows: Ints, near: float, first: Ints, seen: Floats) -> None:
    """Find items and stations around `rows` (P,), robots at work, and write ITEM_TERMS.

    `first` (TERMS,) holds the first component of each term in `seen` (R, F), -1 for one that is not chosen. A robot is
    near a station within `near` [m].
    """
    find_items(floor, rows)
    find_stations(floor, rows, near)
    for row in rows:
        write_item_terms(open_floor(floor), first, row, seen[row])


@TERMS.register
class YardsTerm(Term):
    """One flag: all stations of the kind that the robot needs next are within `together` [m] of each other, or not."""

    name = "yards"
    components = ("one_yard", "several_yards")

    def __init__(self, observed: Observed, *, together: float = 2.0) -> None:
        super().__init__(observed)
        self.together = together
        self._floor = cleaning_in(observed, self.name).site.packed

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags."""
        floor, robots = self._floor.record, self.observed.worlds.robots
        space = Torus(*floor.extent.tolist())
        apart = np.zeros((len(floor.stations), 2), dtype=np.bool_)
        for kind in range(2):
            places = floor.stations[:, floor.kinds == kind]  # (W, K, 2)
            offsets = space.offsets(np.broadcast_to(places[:, :1], places.shape), places)
            apart[:, kind] = ((offsets**2).sum(axis=2) > self.together**2).any(axis=1)
        several = apart[rows // robots, floor.recycled[rows]]
        out[0, rows], out[1, rows] = ~several, several


class FeltFinds(Term):
    """Base class of terms about finds: the pheromones that robots leave where they pick."""

    channel: ClassVar[str]

    def __init__(self, observed: Observed, *, together: float = 2.0) -> None:
        super().__init__(observed)
        cleaning_in(observed, self.name)
        self.together = together
        self._queries = Queries(observed.worlds.minds.buffers["pheromones"])

    def felt(self, rows: Ints) -> tuple[Ints, Flags]:
        """Return how many finds each of `rows` (P,) feels, and whether half of the others lie near the latest."""
        worlds = self.observed.worlds
        seen = self._queries.gather(worlds.now, rows, Filter((self.channel,), moving=False, view_distance=np.inf))
        count = np.diff(seen.start)
        robot = np.repeat(np.arange(len(rows)), count)
        felt = count > 0
        latest = np.zeros(len(rows), dtype=np.int64)
        latest[felt] = np.lexsort((seen.pairs[:, c.PAIR_DIFFUSION], robot))[seen.start[1:][felt] - 1]
        ways = seen.pairs[:, [c.PAIR_DX, c.PAIR_DY]]
        apart = ways - ways[latest[robot]]
        apart -= worlds.extent * np.rint(apart / worlds.extent)
        near = np.bincount(robot[(apart**2).sum(axis=1) <= self.together**2], minlength=len(rows))
        return count, felt & (2 * (near - 1) >= count - 1)


@TERMS.register
class FindsTerm(FeltFinds):
    """One flag: no find is felt; they are apart; or half of them or more lie within `together` [m] of the latest."""

    name = "finds"
    components = ("finds_none", "finds_apart", "finds_together")
    channel = "find"

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags."""
        count, together = self.felt(rows)
        out[0, rows], out[1, rows], out[2, rows] = count == 0, (count > 0) & ~together, together


@TERMS.register
class RecentFindsTerm(FeltFinds):
    """One flag of what was found in the last 24 s, none; one; half or more within `together` [m] of the last; apart."""

    name = "recent_finds"
    components = ("recent_finds_none", "recent_finds_one", "recent_finds_together", "recent_finds_apart")
    channel = "recent find"

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags."""
        count, together = self.felt(rows)
        several = count > 1
        for place, flag in enumerate((count == 0, count == 1, several & together, several & ~together)):
            out[place, rows] = flag


@TERMS.register
class TrueSeasonTerm(Term):
    """One flag: garbage comes anywhere now, or about spots."""

    # No robot can know it: it is for machines that are told (docs/decisions/0214-what-robots-have-heard.md).
    name = "true_season"
    components = ("true_anywhere", "true_spots")

    def __init__(self, observed: Observed) -> None:
        super().__init__(observed)
        self._comings = cleaning_in(observed, self.name).comings

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags."""
        at_spots = np.repeat(self._comings.at_spots, self.observed.worlds.robots)[rows]
        out[0, rows], out[1, rows] = ~at_spots, at_spots
