"""Searches that fill the fields of `Around` which several observation terms read; the letters of shapes are those of
`Around`.
"""  # noqa: D205

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.around import (
    APPROACH,
    PATROL,
    TO_DUMP,
    TO_RECYCLING,
    Around,
    open_around,
    write_way,
)
from clean_swarm_env.physics.cells import (
    NOBODY,
    cells_along,
    fill_cells,
    nearest_of_kind,
    nearest_point,
)
from clean_swarm_env.tasks.cleaning.garbage import LYING, NOTHING
from selforg.arrays import Ints
from selforg.compiler.decorators import kernel, part
from selforg.compiler.records import Words
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.mechanisms.steering.base import (
    OTHER_COLUMNS,
    OTHER_ROW,
    OTHER_VX,
    OTHER_VY,
    OTHER_X,
    OTHER_Y,
    note_others,
    own_velocity,
)

MARGIN = 1.0 + 1e-9
"""Factor by which cells are wider than the range of a search, for rounding."""


@kernel
def search(around: Words[Around], poses: Words[Poses], chosen: Ints, rows: Ints) -> int:
    """Find items, stations and neighbours of the robots in the worlds `chosen` (C,), and what they know of others.

    Lists the robots at work in `rows` (R,) and returns their number.
    """
    count = list_working(around, chosen, rows)
    find_items(around, rows[:count])
    find_stations(around, rows[:count])
    find_heard(around, poses, rows[:count])
    return count


@part
def list_working(around: Words[Around], chosen: Ints, rows: Ints) -> int:
    """List in `rows` (R,) the robots at work in the worlds `chosen` (C,), and return their number.

    The phase of every robot of these worlds becomes PATROL.
    """
    a = open_around(around)
    count = 0
    for world in chosen:
        for row in range(world * a.robots, (world + 1) * a.robots):
            a.phases[row] = PATROL
            if a.working[row]:
                rows[count] = row
                count += 1
    return count


@kernel
def find_items(around: Words[Around], rows: Ints) -> None:
    """Find the nearest item in sight of each of `rows` (P,), and the phase."""
    a = open_around(around)
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
def find_stations(around: Words[Around], rows: Ints) -> None:
    """Find the distances and the ways of `rows` (P,) to the nearest stations of both kinds."""
    a = open_around(around)
    for row in rows:
        x, y, stations = a.positions[row, 0], a.positions[row, 1], a.stations[row // a.robots]
        for kind in range(2):
            station, _ = nearest_of_kind(x, y, kind, stations, a.station_kinds, a.extent)
            if station == NOBODY:  # another task than cleaning
                continue
            way = a.station_ways[row, kind]
            a.station_distances[row, kind] = write_way(a, row, stations[station], a.longest, way)


@kernel
def find_heard(around: Words[Around], poses: Words[Poses], rows: Ints) -> None:
    """Find what each of `rows` (P,) knows of the nearest other robot in range, and count those within each range.

    What is known is of the time at which the row spread its own pose last.
    """
    a, p = open_around(around), open_poses(poses)
    squares, others = a.ranges * a.ranges, np.empty((a.robots, OTHER_COLUMNS))
    for row in rows:
        a.neighbour[row], a.within[row], shortest = -1, 0, np.inf
        if p.rows[row, c.ROW_POSES] == 0:
            continue
        vx, vy = own_velocity(row, poses)
        for k in range(note_others(row, p.own[row, 0, c.POSE_STAMP], np.inf, others, poses)):
            square = others[k, OTHER_X] * others[k, OTHER_X] + others[k, OTHER_Y] * others[k, OTHER_Y]
            for near in range(squares.shape[0]):
                a.within[row, near] += square <= squares[near]
            if square <= squares[-1] and square < shortest:
                shortest, a.neighbour[row] = square, int(others[k, OTHER_ROW])
                a.heard[row] = others[k]
                a.heard[row, OTHER_VX] -= vx
                a.heard[row, OTHER_VY] -= vy
