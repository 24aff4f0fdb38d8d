"""Contacts of robots: discs that do not turn and push each other apart (compiled).

The method is that of Chipmunk (MIT, https://chipmunk-physics.net): sequential impulses along the line of centres, which
begin from those of the substep before, and a correction of overlaps that leaves no velocity. Contacts are solved in the
order of their rows. So all that one substep hands to the next lies in the arrays of `Contacts`.

Shapes: W worlds, N robots a world, R = W * N rows, P contacts of a world.
"""

from typing import Annotated, Final, NamedTuple

import numpy as np

from clean_swarm_env.physics.cells import NOBODY, cell_at, cell_beside, cells_along, fill_cells
from clean_swarm_env.physics.motion import RobotMotion, open_robot_motion
from clean_swarm_env.physics.settings import PhysicsSettings
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Recording, Words
from selforg.space import nearest_image

SKIN: Final = 1e-9  # share of the radius added: robots exactly two radii apart touch in spite of rounding
SLOP: Final = 0.005  # overlap that is left as it is [m]; Chipmunk's own 0.1 would let discs of 0.25 m sink in visibly
ITERATIONS: Final = 10  # over all contacts of a world
OVERLAP_LEFT: Final = 0.9**60  # share of an overlap that is left after a second of corrections, as in Chipmunk
CONTACTS_A_ROBOT: Final = 8  # room; discs that do not overlap have three each. What finds no room is not solved


class Contacts(NamedTuple):
    """Robots that touched in the last substep, and room for what is solved in the next one."""

    touching: Annotated[Ints, "W"]  # number of contacts in the last substep
    pairs: Annotated[Ints, "W P"]  # row * N + smaller row of each, counted within the world, rising
    impulses: Annotated[Floats, "W P"]  # by which it pushed both apart, by mass [m/s]
    first: Annotated[Ints, "P"]  # scratch from here on: both rows of a contact
    second: Annotated[Ints, "P"]
    normals: Annotated[Floats, "P 2"]  # from the first to the second
    apart: Annotated[Floats, "P"]  # velocity that takes away a part of the overlap [m/s]
    lifts: Annotated[Floats, "P"]  # corrections of overlaps so far, as impulses by mass [m/s]
    pushes: Annotated[Floats, "P"]  # impulses so far, by mass [m/s]
    shifts: Annotated[Floats, "R 2"]  # velocities that correct overlaps in this substep only [m/s]
    cells: Annotated[Ints, "lines columns"]  # see `cells`
    links: Annotated[Ints, "N"]
    solid: int  # 1 where robots touch at all
    reach: float  # distance of two centres below which robots touch [m]
    correction: float  # share of an overlap that goes away in a substep, by its length [1/s]


CONTACTS = Recording(Contacts)
open_contacts = CONTACTS.open


def no_contacts(settings: PhysicsSettings) -> Contacts:
    """Return the contacts of worlds in which nobody has touched anybody yet."""
    worlds, robots, timestep = settings.worlds, settings.robots, settings.timestep
    solid = settings.contacts == "solid" and robots > 1
    room = min(robots * (robots - 1) // 2, CONTACTS_A_ROBOT * robots) if solid else 0
    reach = 2.0 * settings.radius * (1.0 + SKIN)
    cells = cells_along(robots, reach, np.array([settings.width, settings.height])) if solid else (0, 0)
    return Contacts(
        touching=np.zeros(worlds, np.int64),
        pairs=np.zeros((worlds, room), np.int64),
        impulses=np.zeros((worlds, room)),
        first=np.zeros(room, np.int64),
        second=np.zeros(room, np.int64),
        normals=np.zeros((room, 2)),
        apart=np.zeros(room),
        lifts=np.zeros(room),
        pushes=np.zeros(room),
        shifts=np.zeros((worlds * robots, 2)),
        cells=np.zeros(cells, np.int64),
        links=np.zeros(robots, np.int64),
        solid=int(solid),
        reach=reach,
        correction=(1.0 - OVERLAP_LEFT**timestep) / timestep,
    )


@inlined
def meet(row: int, other: int, found: int, m: RobotMotion, c: Contacts) -> int:
    """Note two rows, the first one larger, if their robots touch; return the number of contacts found."""
    dx = nearest_image(m.positions[other, 0] - m.positions[row, 0], m.width)
    dy = nearest_image(m.positions[other, 1] - m.positions[row, 1], m.height)
    square = dx * dx + dy * dy
    if square >= c.reach * c.reach or found == c.first.shape[0]:
        return found
    place = found  # contacts of a row stand by their other row, in whatever order they are found
    while place > 0 and c.first[place - 1] == row and c.second[place - 1] > other:
        c.first[place], c.second[place], c.apart[place] = row, c.second[place - 1], c.apart[place - 1]
        c.normals[place, 0], c.normals[place, 1] = c.normals[place - 1, 0], c.normals[place - 1, 1]
        place -= 1
    length = np.sqrt(square)
    c.first[place], c.second[place] = row, other
    c.normals[place, 0], c.normals[place, 1] = (dx / length, dy / length) if length > 0.0 else (1.0, 0.0)
    c.apart[place] = c.correction * max(c.reach - length - SLOP, 0.0)
    return found + 1


@inlined
def find_contacts(world: int, m: RobotMotion, c: Contacts) -> int:
    """Find the contacts of a world; return their number."""
    robots = m.positions.shape[0] // c.touching.shape[0]
    lines, columns = c.cells.shape
    first, found = world * robots, 0
    if lines > 0:
        fill_cells(m.positions, first, m.present[first : first + robots], m.extent, c.cells, c.links)
    for row in range(first, first + robots):
        if not m.present[row]:
            continue
        if lines == 0:
            for other in range(first, row):
                if m.present[other]:
                    found = meet(row, other, found, m, c)
            continue
        line, column = cell_at(m.positions[row, 1], lines, m.height), cell_at(m.positions[row, 0], columns, m.width)
        for walk in range(9):
            point = cell_beside(line, column, walk, c.cells)
            while point != NOBODY and first + point < row:  # numbers in a cell rise
                found = meet(row, first + point, found, m, c)
                point = c.links[point]
    return found


@inlined
def begin_impulses(world: int, found: int, robots: int, c: Contacts) -> None:
    """Begin from the impulses of the substep before; 0 where two robots did not touch then."""
    first, known = world * robots, 0
    for index in range(found):
        pair = (c.first[index] - first) * robots + c.second[index] - first
        while known < c.touching[world] and c.pairs[world, known] < pair:
            known += 1
        same = known < c.touching[world] and c.pairs[world, known] == pair
        c.pushes[index] = c.impulses[world, known] if same else 0.0
        c.lifts[index] = 0.0


@inlined
def exchange(velocities: Floats, index: int, impulse: float, c: Contacts) -> None:
    """Push the two robots of a contact apart by an impulse by mass [m/s]."""
    x, y = impulse * c.normals[index, 0], impulse * c.normals[index, 1]
    velocities[c.first[index], 0] -= x
    velocities[c.first[index], 1] -= y
    velocities[c.second[index], 0] += x
    velocities[c.second[index], 1] += y


@inlined
def parting(velocities: Floats, index: int, c: Contacts) -> float:
    """Return the velocity at which the two robots of a contact part [m/s]."""
    one, other = c.first[index], c.second[index]
    along = (velocities[other, 0] - velocities[one, 0]) * c.normals[index, 0]
    return float(along + (velocities[other, 1] - velocities[one, 1]) * c.normals[index, 1])


@lean_kernel
def solve(world: int, motion: Words[RobotMotion], contacts: Words[Contacts]) -> bool:
    """Change the velocities of the robots of a world that touch, and fill their `shifts`; return whether any do.

    An impulse by mass j changes the velocity of parting by 2 j, because all robots have the same mass. Robots push, and
    never pull: neither sum of impulses goes below 0.
    """
    m, c = open_robot_motion(motion), open_contacts(contacts)
    robots = m.positions.shape[0] // c.touching.shape[0]
    found = find_contacts(world, m, c) if c.solid else 0
    if found == 0:
        c.touching[world] = 0
        return False
    begin_impulses(world, found, robots, c)
    for row in range(world * robots, (world + 1) * robots):
        c.shifts[row, 0] = c.shifts[row, 1] = 0.0
    for index in range(found):
        exchange(m.velocities, index, c.pushes[index], c)
    for _ in range(ITERATIONS):
        for index in range(found):
            lift = max(c.lifts[index] + 0.5 * (c.apart[index] - parting(c.shifts, index, c)), 0.0)
            push = max(c.pushes[index] - 0.5 * parting(m.velocities, index, c), 0.0)
            exchange(c.shifts, index, lift - c.lifts[index], c)
            exchange(m.velocities, index, push - c.pushes[index], c)
            c.lifts[index], c.pushes[index] = lift, push
    c.touching[world] = found
    for index in range(found):
        one, other = c.first[index] - world * robots, c.second[index] - world * robots
        c.pairs[world, index], c.impulses[world, index] = one * robots + other, c.pushes[index]
    return True
