"""Items and stations around the robots: the record that compiled terms of cleaning read, and the searches that fill it.

Shapes: W worlds, N robots a world, R = W * N rows, M items and L stations a world.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from clean_swarm_env.learning.observation.around import write_offset
from clean_swarm_env.learning.observation.term import Observed
from clean_swarm_env.physics.cells import NOBODY, cells_along, fill_cells, nearest_of_kind, nearest_point
from clean_swarm_env.tasks.cleaning.garbage import LYING, NOTHING
from clean_swarm_env.tasks.cleaning.settings import CleaningSettings
from selector.documents.errors import DocumentError
from selforg.arrays import READ, SCRATCH, Floats, Ints
from selforg.compiler.decorators import inlined, kernel, part
from selforg.compiler.records import Recording, Words
from selforg.space import nearest_image

PHASES = ("patrol", "approach", "to_recycling", "to_dump")
"""In the order of their numbers: no item in sight, an item in sight, with cargo, with recycled cargo."""
PATROL, APPROACH, TO_RECYCLING, TO_DUMP = range(len(PHASES))
MARGIN = 1.0 + 1e-9
"""Factor by which cells are wider than the range of a search, for rounding."""


class ItemsAround(NamedTuple):
    """Arrays of the worlds, settings, and what is found for every observation. Terms only read them."""

    robots: int  # N
    extent: Annotated[Floats, "2", READ]  # of the torus [m]
    positions: Annotated[Floats, "R 2", READ]  # of the robots [m]
    headings: Annotated[Floats, "R", READ]  # [rad]
    cargo: Annotated[Ints, "R", READ]  # item that the robot carries, NOTHING without one
    recycled: Annotated[Ints, "R", READ]  # 1 where the cargo has been recycled
    items: Annotated[Floats, "W M 2", READ]  # places of the items [m]
    stage: Annotated[Ints, "W M", READ]  # LYING, CARRIED, DONE or ABSENT
    stations: Annotated[Floats, "W L 2", READ]  # [m]
    station_kinds: Annotated[Ints, "L", READ]  # RECYCLING or DUMP
    sight: Annotated[Floats, "R", READ]  # distance within which the robot sees items [m]
    longest: float  # half the diagonal of the torus [m]
    station_range: float  # distance to a station within which a robot is near it [m]
    phases: Annotated[Ints, "R", SCRATCH]  # numbers of `PHASES`
    item: Annotated[Ints, "R", SCRATCH]  # nearest item in sight, -1 without one
    station_distances: Annotated[Floats, "R 2", SCRATCH]  # to the nearest recycling station and dump [m]
    station_ways: Annotated[Floats, "R 2 3", SCRATCH]  # the ways to them, see `write_way`, by `longest`


ITEMS_AROUND = Recording(ItemsAround)
open_items = ITEMS_AROUND.open


def cleaning_of(observed: Observed, term: str) -> Any:  # noqa: ANN401  (a Cleaning, which stands above this module)
    """Return the task of the robots, which a term is about; DocumentError if it is not cleaning."""
    task = observed.worlds.task
    if not isinstance(task.settings, CleaningSettings):
        raise DocumentError(f"observation: terms: {term}: expected the task Cleaning, got {task.name}")
    return task


@inlined
def write_way(around: ItemsAround, row: int, place: Floats, scale: float, way: Floats) -> float:
    """Write the way of a row to a place (2,) [m], see `write_offset`; return the distance [m]."""
    dx = nearest_image(place[0] - around.positions[row, 0], around.extent[0])
    dy = nearest_image(place[1] - around.positions[row, 1], around.extent[1])
    return write_offset(around.headings[row], dx, dy, scale, way)


@inlined
def copy_way(way: Floats, out: Floats) -> None:
    """Copy a way (3,) to the first places of `out`."""
    out[0], out[1], out[2] = way[0], way[1], way[2]


@part
def reset_phases(around: Words[ItemsAround], chosen: Ints) -> None:
    """Set the phase of every robot in the worlds `chosen` (C,) to PATROL."""
    a = open_items(around)
    for world in chosen:
        for row in range(world * a.robots, (world + 1) * a.robots):
            a.phases[row] = PATROL


@kernel
def find_items(around: Words[ItemsAround], rows: Ints) -> None:
    """Find the nearest item in sight of each of `rows` (P,), and the phase."""
    a = open_items(around)
    items = a.items.shape[1]
    cells = np.empty(cells_along(items, a.sight.max() * MARGIN, a.extent), np.int64)
    links, lying, filled = np.empty(items, np.int64), np.empty(items, np.bool_), -1
    for row in rows:
        world = row // a.robots
        if world != filled:
            for item in range(items):
                lying[item] = a.stage[world, item] == LYING
            fill_cells(a.items[world], 0, lying, a.extent, cells, links)
            filled = world
        x, y = a.positions[row, 0], a.positions[row, 1]
        item, _ = nearest_point(x, y, a.sight[row], a.items[world], lying, a.extent, cells, links)
        a.item[row] = item
        if a.cargo[row] != NOTHING:
            a.phases[row] = TO_DUMP if a.recycled[row] == 1 else TO_RECYCLING
        elif item != NOBODY:
            a.phases[row] = APPROACH


@part
def find_stations(around: Words[ItemsAround], rows: Ints) -> None:
    """Find the distances and the ways of `rows` (P,) to the nearest stations of both kinds."""
    a = open_items(around)
    for row in rows:
        x, y, stations = a.positions[row, 0], a.positions[row, 1], a.stations[row // a.robots]
        for kind in range(2):
            station, _ = nearest_of_kind(x, y, kind, stations, a.station_kinds, a.extent)
            way = a.station_ways[row, kind]
            a.station_distances[row, kind] = write_way(a, row, stations[station], a.longest, way)
