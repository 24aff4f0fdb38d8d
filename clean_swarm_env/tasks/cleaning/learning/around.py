"""Searches for items and stations around the robots, for observation terms, and the phases of their work (compiled).

What they find is in `FloorRecord`.
"""

from __future__ import annotations

from typing import Any

from clean_swarm_env.learning.observation.around import write_offset
from clean_swarm_env.learning.observation.term import Observed
from clean_swarm_env.physics.cells import NOBODY, nearest_of_kind, nearest_point
from clean_swarm_env.tasks.cleaning.cargo import list_lying
from clean_swarm_env.tasks.cleaning.garbage import NOTHING
from clean_swarm_env.tasks.cleaning.records import FloorRecord, open_floor
from clean_swarm_env.tasks.cleaning.settings import CleaningSettings
from selector.documents.plain import must_fit
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined, part
from selforg.compiler.records import Handle
from selforg.space import nearest_image

PHASES = ("patrol", "approach", "to_recycling", "to_dump")
"""In the order of their numbers: no item in sight, an item in sight, with cargo, with recycled cargo."""
PATROL, APPROACH, TO_RECYCLING, TO_DUMP = range(len(PHASES))


def cleaning_in(observed: Observed, term: str) -> Any:  # noqa: ANN401  (a Cleaning, which stands above this module)
    """Return the task of the robots, which a term is about; DocumentError if it is not cleaning."""
    task = observed.worlds.task
    must_fit(isinstance(task.settings, CleaningSettings), f"observation: terms: {term}", "the task Cleaning", task.name)
    return task


@inlined
def write_way(floor: FloorRecord, row: int, place: Floats, scale: float, way: Floats) -> float:
    """Write the way of a row to a place (2,) [m], see `write_offset`; return the distance [m]."""
    dx = nearest_image(place[0] - floor.robots[row, 0], floor.extent[0])
    dy = nearest_image(place[1] - floor.robots[row, 1], floor.extent[1])
    return write_offset(floor.headings[row], dx, dy, scale, way)


@part
def find_items(floor: Handle[FloorRecord], rows: Ints) -> None:
    """Find the nearest item in sight of each of `rows` (P,), and its phase."""
    f, filled = open_floor(floor), -1
    for row in rows:
        world, place = row // (f.robots.shape[0] // f.stage.shape[0]), f.robots[row]
        if world != filled:
            list_lying(world, False, floor)
            filled = world
        item, _ = nearest_point(place[0], place[1], f.sight[row], f.items[world], f.lying, f.extent, f.cells, f.links)
        f.in_sight[row], f.phases[row] = item, PATROL if item == NOBODY else APPROACH
        if f.cargo[row] != NOTHING:
            f.phases[row] = TO_DUMP if f.recycled[row] == 1 else TO_RECYCLING


@part
def find_stations(floor: Handle[FloorRecord], rows: Ints, near: float) -> None:
    """Find the ways of `rows` (P,) to the nearest stations of both kinds, and how near these are by `near` [m]."""
    f = open_floor(floor)
    for row in rows:
        stations, place = f.stations[row // (f.robots.shape[0] // f.stage.shape[0])], f.robots[row]
        for kind in range(2):
            station, away = nearest_of_kind(place[0], place[1], kind, stations, f.kinds, f.extent)
            write_way(f, row, stations[station], f.longest, f.station_ways[row, kind])
            f.nearness[row, kind] = 1.0 - away / near
