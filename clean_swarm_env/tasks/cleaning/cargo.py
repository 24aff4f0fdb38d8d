"""The stages of a tick that concern the floor and the minds: own sensors, cargo, and ways to the stations (compiled).

Shapes: see `clean_swarm_env.tasks.cleaning.records`.
"""

from __future__ import annotations

import numpy as np

from clean_swarm_env.physics.cells import distance, fill_cells, nearest_of_kind, nearest_point
from clean_swarm_env.tasks.cleaning.garbage import CARRIED, DONE, LYING, NOTHING
from clean_swarm_env.tasks.cleaning.records import FloorRecord, MindsRecord, open_floor, open_minds
from clean_swarm_env.tasks.cleaning.robot import (
    AT_DUMP,
    AT_RECYCLING,
    CARRYING,
    DIST_DUMP,
    DIST_RECYCLING,
    GARBAGE_AT,
    GARBAGE_FOUND,
    GARBAGE_SEEN,
    RECYCLED,
)
from clean_swarm_env.tasks.cleaning.settings import DUMP, RECYCLING
from selforg.arrays import Flags, Floats, Ints
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import inlined, lean_kernel, long_kernel, part
from selforg.compiler.records import Handle, Written
from selforg.network import state as st
from selforg.space import nearest_image
from selforg.walls.segments import Walls, is_hidden

START_PICK, START_RECYCLE, START_DUMP = range(3)  # columns of `MindsRecord.starting`


@long_kernel
def read_sensors(
    now: float, rows: Ints, floor: Written[FloorRecord], minds: Written[MindsRecord], walls: Handle[Walls]
) -> int:
    """Write the robots' own sensors into the readings, and note the nearest item that each could see or take.

    Robots that carry nothing look for items that none of them has found lately. This is a step, see `selforg.program`.
    """
    f, readings = open_floor(floor), open_minds(minds).readings
    worlds = f.stage.shape[0]
    per_world = f.robots.shape[0] // worlds
    for world in range(worlds):
        if f.finders:
            for item in range(f.found.shape[1]):
                f.found[world, item] = max(f.found[world, item] - 1, 0)
        for finders in range(1 + f.finders):
            list_lying(world, finders == 1, floor)
            for row in range(world * per_world, (world + 1) * per_world):
                if finders == (f.room[row] == 0):
                    read_row(row, world, f, readings, walls)
    return 0


@inlined
def read_row(row: int, world: int, f: FloorRecord, readings: Floats, walls: Handle[Walls]) -> None:
    """Write the sensors of one robot; see `read_sensors`.

    A robot that has room for another item like those that it carries, and sees one, does not count as carrying.
    """
    x, y, stations, sight = f.robots[row, 0], f.robots[row, 1], f.stations[world], f.sight[row]
    reach = max(sight, f.at_item, f.pick_distance)
    item, near = NOTHING, np.inf
    if f.blind[row] > 0:
        f.blind[row] -= 1
    elif f.stage.shape[1] > 0:
        item, near = nearest_point(x, y, reach, f.items[world], f.lying, f.extent, f.cells, f.links)
    behind = item != NOTHING and f.walled and is_behind(row, f.items[world, item], f, walls)
    if behind and f.hidden:
        item, near = nearest_in_view(row, world, reach, f, walls)
        behind = False
    f.nearest[row] = item
    loaded = f.cargo[row] != NOTHING
    carrying = loaded and not (f.room[row] > 1 and near <= sight and takes(row, world, item, f))
    _, to_recycling = nearest_of_kind(x, y, RECYCLING, stations, f.kinds, f.extent)
    _, to_dump = nearest_of_kind(x, y, DUMP, stations, f.kinds, f.extent)
    readings[row, GARBAGE_SEEN] = 1.0 if near <= sight else 0.0
    readings[row, GARBAGE_AT] = 1.0 if near <= f.at_item and not behind else 0.0
    readings[row, GARBAGE_FOUND] = 1.0 if near <= sight or loaded else 0.0
    readings[row, CARRYING] = 1.0 if carrying else 0.0
    readings[row, RECYCLED] = 1.0 if f.recycled[row] else 0.0
    readings[row, AT_RECYCLING] = 1.0 if to_recycling <= f.at_station else 0.0
    readings[row, AT_DUMP] = 1.0 if to_dump <= f.at_station else 0.0
    readings[row, DIST_RECYCLING] = to_recycling
    readings[row, DIST_DUMP] = to_dump


@inlined
def takes(row: int, world: int, item: int, f: FloorRecord) -> bool:
    """Return whether a robot has room for an item: items that have been recycled are carried one by one."""
    if f.cargo[row] == NOTHING:
        return bool(f.room[row] > 0)
    if f.recycled[row] == 1 or f.leftover[world, item] == 1:
        return False
    count, carried = 0, f.cargo[row]
    while carried != NOTHING:
        count, carried = count + 1, f.under[world, carried]
    return bool(count < f.room[row])


@inlined
def is_behind(row: int, place: Floats, f: FloorRecord, walls: Handle[Walls]) -> bool:
    """Return whether a wall lies between a robot and a place (2,) [m]."""
    x, y = f.robots[row, 0], f.robots[row, 1]
    dx, dy = nearest_image(place[0] - x, f.extent[0]), nearest_image(place[1] - y, f.extent[1])
    return is_hidden(x, y, dx, dy, f.extent, walls)


@inlined
def nearest_in_view(row: int, world: int, sight: float, f: FloorRecord, walls: Handle[Walls]) -> tuple[int, float]:
    """Return the nearest marked item within `sight` [m] of a robot that is not behind a wall, and its distance [m]."""
    best, shortest = NOTHING, np.inf
    for item in range(f.lying.shape[0]):
        if f.lying[item]:
            place = f.items[world, item]
            away = distance(f.robots[row, 0], f.robots[row, 1], place[0], place[1], f.extent)
            if away <= sight and away < shortest and not is_behind(row, place, f, walls):
                best, shortest = item, away
    return best, shortest


@part
def list_lying(world: int, unknown: bool, floor: Handle[FloorRecord]) -> None:
    """Mark the items of a world that lie, or those of them that are still `unknown`, and put them into the cells."""
    f = open_floor(floor)
    for item in range(f.stage.shape[1]):
        f.lying[item] = f.stage[world, item] == LYING and not (unknown and f.found[world, item] > 0)
    fill_cells(f.items[world], 0, f.lying, f.extent, f.cells, f.links)


@lean_kernel
def handle_cargo_as_decided(
    now: float, rows: Ints, floor: Written[FloorRecord], minds: Handle[MindsRecord], walls: Handle[Walls]
) -> int:
    """Handle the cargo of robots whose behaviours to pick, recycle or dump have just started; see `handle_cargo`.

    This is a step, see `selforg.program`.
    """
    m, f = open_minds(minds), open_floor(floor)
    for row in range(m.starting.shape[0]):
        for k in range(3):
            m.starting[row, k] = m.marks[row, st.STARTED, m.handling[k]] != 0 and f.standing[row] == 0
        if f.room[row] != 1 and f.standing[row] == 0:  # several items may lie in reach
            m.starting[row, START_PICK] = m.marks[row, st.EXECUTING, m.handling[START_PICK]] != 0
    return handle_cargo(floor, minds, walls)


@lean_kernel
def handle_cargo_in_reach(
    floor: Written[FloorRecord], minds: Handle[MindsRecord], working: Flags, walls: Handle[Walls]
) -> int:
    """Handle the cargo of robots that are `working` (R,) wherever their sensors allow it; see `handle_cargo`."""
    m, standing = open_minds(minds), open_floor(floor).standing
    for row in range(m.starting.shape[0]):
        able = working[row] and standing[row] == 0
        carrying, recycled = m.readings[row, CARRYING] == 1.0, m.readings[row, RECYCLED] == 1.0
        m.starting[row, START_PICK] = able and not carrying and m.readings[row, GARBAGE_AT] == 1.0
        m.starting[row, START_RECYCLE] = able and carrying and not recycled and m.readings[row, AT_RECYCLING] == 1.0
        m.starting[row, START_DUMP] = able and carrying and recycled and m.readings[row, AT_DUMP] == 1.0
    return handle_cargo(floor, minds, walls)


@inlined
def handle_cargo(floor: Written[FloorRecord], minds: Handle[MindsRecord], walls: Handle[Walls]) -> int:
    """Handle the cargo of the robots that start to pick, recycle or dump, in the order of rows.

    A robot picks the item that was nearest when it sensed. If another robot has just taken that, it picks the item that
    is nearest now. A robot that carries nothing notes that it has found the item. Fills `picked` and returns how many
    items were picked.
    """
    f, m = open_floor(floor), open_minds(minds)
    starting, count = m.starting, 0
    per_world = f.robots.shape[0] // f.items.shape[0]
    for row in range(f.robots.shape[0]):
        world = row // per_world
        if starting[row, START_PICK] and (f.cargo[row] == NOTHING or f.room[row] > 1):
            x, y, item, near = f.robots[row, 0], f.robots[row, 1], f.nearest[row], np.inf
            if item != NOTHING and f.stage[world, item] == LYING:
                near = distance(x, y, f.items[world, item, 0], f.items[world, item, 1], f.extent)
            elif item != NOTHING:
                list_lying(world, f.room[row] == 0, floor)
                reach = f.pick_distance
                item, near = nearest_point(x, y, reach, f.items[world], f.lying, f.extent, f.cells, f.links)
            if item != NOTHING and f.walled and is_behind(row, f.items[world, item], f, walls):
                item = NOTHING
            if item != NOTHING and near <= f.pick_distance and f.room[row] == 0:
                f.found[world, item] = f.found_again
            elif item != NOTHING and near <= f.pick_distance and takes(row, world, item, f):
                f.under[world, item] = f.cargo[row]
                f.cargo[row] = item
                f.recycled[row] = f.leftover[world, item]
                place, kind = f.items[world, item], DUMP if f.recycled[row] else RECYCLING
                _, f.leg[row] = nearest_of_kind(place[0], place[1], kind, f.stations[world], f.kinds, f.extent)
                f.stage[world, item] = CARRIED
                f.picked[count, 0], f.picked[count, 1] = row, item
                count += 1
        if starting[row, START_RECYCLE] and f.cargo[row] != NOTHING:
            f.recycled[row] = 1
            f.leg[row] = m.readings[row, DIST_DUMP]
        if starting[row, START_DUMP] and f.cargo[row] != NOTHING and f.recycled[row]:
            while f.cargo[row] != NOTHING:
                f.stage[world, f.cargo[row]] = DONE
                f.cargo[row] = f.under[world, f.cargo[row]]
                f.done[world] += 1
            f.recycled[row] = 0
    return count


@lean_kernel
def reset_commands(
    now: float, rows: Ints, floor: Handle[FloorRecord], minds: Handle[MindsRecord], commands: Handle[Commanded]
) -> int:
    """Clear the last commands, command the ways to the nearest stations, and list the rows in which each mover runs.

    This is a step, see `selforg.program`.
    """
    f, m, given = open_floor(floor), open_minds(minds), open_commanded(commands)
    per_world = f.robots.shape[0] // f.stations.shape[0]
    for mover in range(m.movers.shape[0]):
        m.counts[mover] = 0
    for row in range(given.commanded.shape[0]):
        given.commanded[row] = given.in_place[row] = False
        for k in range(m.transport.shape[0]):
            if m.marks[row, st.EXECUTING, m.transport[k]]:
                stations, place = f.stations[row // per_world], f.robots[row]
                station, _ = nearest_of_kind(place[0], place[1], k, stations, f.kinds, f.extent)
                x = nearest_image(stations[station, 0] - place[0], f.extent[0])
                y = nearest_image(stations[station, 1] - place[1], f.extent[1])
                length = np.sqrt(x * x + y * y)
                given.vectors[row, 0] = x / length if length > 0.0 else 0.0
                given.vectors[row, 1] = y / length if length > 0.0 else 0.0
                given.commanded[row] = True
        for mover in range(m.movers.shape[0]):
            if m.marks[row, st.EXECUTING, m.movers[mover]]:
                m.running[mover, m.counts[mover]] = row
                m.counts[mover] += 1
    return 0
