"""The ways of cleaning robots round walls: to the nearest station, and to the nearest item (compiled)."""

from __future__ import annotations

from typing import Annotated, Final

import numpy as np

from clean_swarm_env.physics.cells import nearest_of_kind
from clean_swarm_env.tasks.cleaning.garbage import NOTHING
from clean_swarm_env.tasks.cleaning.movers import Movers
from clean_swarm_env.tasks.cleaning.records import FloorRecord, MindsRecord, open_floor, open_minds
from clean_swarm_env.tasks.cleaning.site import Site
from clean_swarm_env.world.view import TaskView
from selforg.arrays import SCRATCH, Floats, Ints, Links, Octets
from selforg.commands import Commanded, Commands, open_commanded
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Handle
from selforg.declared import make_arrays
from selforg.network import state as st
from selforg.walls.ways import NO_FIELD, shared_square, square_of, to_target, way_down

STRAIGHT_ON: Final = -1
"""In place of the square of a target: the straight way there is open,"""
LED: Final = -2
"""or the robot has its way round walls."""


class Rounds:
    """Leads robots that go to a station or an item round the walls."""

    _goals: Annotated[Floats, "R 2", SCRATCH]  # offset to the target [m], zero where a robot goes to none
    _squares: Annotated[Ints, "R 2", SCRATCH]  # line and column of the target, STRAIGHT_ON

    def __init__(self, world: TaskView, site: Site, movers: Movers) -> None:
        self._site, self._movers, self._ways = site, movers, world.ways
        make_arrays(self, R=world.rows)

    def command_ways(self, commands: Commands) -> None:
        """Turn the commands of robots that go to a station or an item into the ways there."""
        floor, minds, ways = self._site.packed.handle, self._movers.packed.handle, self._ways
        goals, squares = self._goals, self._squares
        find_goals(floor, minds, self._movers.to_garbage, goals, squares, ways.room, ways.pitch, ways.extent)
        follow_straight(goals, squares, commands.packed.handle)
        places = self._site.packed.record.robots
        while (row := first_to_lead(squares)) >= 0:
            line, column = squares[row].tolist()
            if ways.numbers[line, column] == NO_FIELD:
                ways.add(line, column)  # which may give up the field of another row, whose turn then comes again
            follow_round(
                places, squares, ways.numbers, ways.fields, ways.room, ways.pitch, ways.extent, commands.packed.handle
            )


@lean_kernel
def find_goals(
    floor: Handle[FloorRecord],
    minds: Handle[MindsRecord],
    to_garbage: int,
    goals: Floats,
    squares: Ints,
    room: Octets,
    pitch: Floats,
    extent: Floats,
) -> None:
    """Write the offset to the target of each row, and its square unless the straight way there is open."""
    f, m = open_floor(floor), open_minds(minds)
    per_world = f.robots.shape[0] // f.stations.shape[0]
    for row in range(f.robots.shape[0]):
        world, x, y = row // per_world, f.robots[row, 0], f.robots[row, 1]
        goals[row, 0], goals[row, 1], squares[row, 0] = 0.0, 0.0, STRAIGHT_ON
        tx, ty, goes, station = 0.0, 0.0, False, NOTHING
        for k in range(m.transport.shape[0]):
            if m.marks[row, st.EXECUTING, m.transport[k]]:
                station, _ = nearest_of_kind(x, y, k, f.stations[world], f.kinds, f.extent)
                tx, ty, goes = f.stations[world, station, 0], f.stations[world, station, 1], True
        if to_garbage >= 0 and m.marks[row, st.EXECUTING, to_garbage] and f.nearest[row] != NOTHING:
            tx, ty, goes = f.items[world, f.nearest[row], 0], f.items[world, f.nearest[row], 1], True
        if goes:
            goals[row, 0], goals[row, 1], straight = to_target(x, y, tx, ty, extent, room, pitch)
            if not straight and station != NOTHING:
                squares[row, 0], squares[row, 1] = square_of(tx, ty, room, pitch)
            elif not straight:
                squares[row, 0], squares[row, 1] = shared_square(tx, ty, room, pitch, extent)


@lean_kernel
def first_to_lead(squares: Ints) -> int:
    """Return the first row that still has to be led round walls, -1 if there is none."""
    for row in range(squares.shape[0]):
        if squares[row, 0] >= 0:
            return row
    return -1


@lean_kernel
def follow_straight(goals: Floats, squares: Ints, commands: Handle[Commanded]) -> None:
    """Command the way of 1 m/s to the targets to which the straight way is open."""
    given = open_commanded(commands)
    for row in range(goals.shape[0]):
        if squares[row, 0] == STRAIGHT_ON:
            go(row, goals[row, 0], goals[row, 1], given)


@lean_kernel
def follow_round(
    places: Floats,
    squares: Ints,
    numbers: Ints,
    fields: Links,
    room: Octets,
    pitch: Floats,
    extent: Floats,
    commands: Handle[Commanded],
) -> None:
    """Command the way of 1 m/s down the fields that there are, to robots at places (R, 2) [m]; they are LED then."""
    given = open_commanded(commands)
    for row in range(squares.shape[0]):
        number = numbers[squares[row, 0], squares[row, 1]] if squares[row, 0] >= 0 else NO_FIELD
        if number == NO_FIELD:
            continue
        squares[row, 0] = LED
        x, y = way_down(places[row, 0], places[row, 1], fields[number], room, pitch, extent)
        go(row, x, y, given)


@inlined
def go(row: int, x: float, y: float, given: Commanded) -> None:
    """Command 1 m/s along (x, y) to a robot that has a command; none if that is zero."""
    length = np.sqrt(x * x + y * y)
    if length > 0.0 and given.commanded[row]:
        given.vectors[row, 0], given.vectors[row, 1] = x / length, y / length
