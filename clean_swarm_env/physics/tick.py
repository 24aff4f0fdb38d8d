"""A whole control period of the physics with its collision counts, in one call where compiled code calls Chipmunk.

`go_on` runs a world through its substeps. Where Python has to let robots touch, it stops before the step of pymunk, and
`land_and_go_on` continues. Substeps and counts are those of `CollisionCounter.count` after each substep, in the same
order within each world.

Shapes: W worlds, N robots a world, R = W * N rows.
"""

from clean_swarm_env.physics.chipmunk_calls import Chipmunk, free_space, make_space, open_chipmunk, touch
from clean_swarm_env.physics.collisions import Counts, count_world, open_counts
from clean_swarm_env.physics.drive import DriveState, open_drive, update_drives
from clean_swarm_env.physics.motion import RobotMotion, land, open_robot_motion, push, search_contacts, set_wanted
from selforg.arrays import Floats
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import inlined, lean_kernel, part
from selforg.compiler.records import Words, Written

NO_SPACE, IN_PYTHON = 0, -1
"""In place of the address of a space: no robots have touched in this tick; Python has to let robots touch."""


@inlined
def count(world: int, motion: Words[RobotMotion], counts: Written[Counts]) -> None:
    """Count one world and add the events to those of the tick."""
    m, c = open_robot_motion(motion), open_counts(counts)
    count_world(world, m.positions, m.present, counts)
    robots = m.parts.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        c.entered_in_tick[row] += c.entered[row]


@part
def advance(
    world: int,
    space: int,
    last: bool,
    speed: Floats,
    turn_rate: Floats,
    motion: Written[RobotMotion],
    chipmunk: Words[Chipmunk],
) -> int:
    """Run a world through a substep, the `last` one of its space or not; return the space, see `NO_SPACE`."""
    m = open_robot_motion(motion)
    contact = search_contacts(world, m)
    set_wanted(world, not contact, speed, turn_rate, m)
    if contact:
        push(world, m)
        if open_chipmunk(chipmunk).functions[0] == 0:
            return IN_PYTHON
        if space == NO_SPACE:
            space = make_space(world, motion, chipmunk)
        touch(world, space, last, motion, chipmunk)
        land(world, motion)
    return space


@lean_kernel
def go_on(
    world: int,
    left: int,
    drive: Words[DriveState],
    motion: Written[RobotMotion],
    counts: Written[Counts],
    chipmunk: Words[Chipmunk],
) -> int:
    """Run a world through its `left` substeps; return those left, of which Python has to run the first."""
    d, space = open_drive(drive), NO_SPACE
    while left > 0:
        space = advance(world, space, left == 1, d.speed, d.turn_rate, motion, chipmunk)
        if space == IN_PYTHON:
            return left
        count(world, motion, counts)
        left -= 1
    if space != NO_SPACE:
        free_space(space, motion, chipmunk)
    return 0


@lean_kernel
def begin_tick(
    now: float,
    substeps: int,
    commands: Words[Commanded],
    drive: Written[DriveState],
    motion: Written[RobotMotion],
    counts: Written[Counts],
    chipmunk: Words[Chipmunk],
) -> int:
    """Give the drives their commands at `now` [s] and run every world as far as compiled code can.

    Returns how many worlds have substeps left.
    """
    given, m, c = open_commanded(commands), open_robot_motion(motion), open_counts(counts)
    update_drives(given.vectors, given.commanded, given.in_place, m.headings, now, drive)
    for row in range(c.entered_in_tick.shape[0]):
        c.entered_in_tick[row] = 0
    waiting = 0
    for world in range(m.left.shape[0]):
        m.left[world] = go_on(world, substeps, drive, motion, counts, chipmunk)
        waiting += m.left[world] > 0
    return waiting


@lean_kernel
def land_and_go_on(
    world: int,
    left: int,
    drive: Words[DriveState],
    motion: Written[RobotMotion],
    counts: Written[Counts],
    chipmunk: Words[Chipmunk],
) -> int:
    """Continue a world after a substep that Python ran in pymunk; see `go_on`."""
    land(world, motion)
    count(world, motion, counts)
    return go_on(world, left - 1, drive, motion, counts, chipmunk)


@lean_kernel
def substep_worlds(speed: Floats, turn_rate: Floats, motion: Written[RobotMotion], chipmunk: Words[Chipmunk]) -> int:
    """Run a substep of every world, speed (R,) [m/s], turn_rate (R,) [rad/s]; return how many wait for Python."""
    m, waiting = open_robot_motion(motion), 0
    for world in range(m.left.shape[0]):
        space = advance(world, NO_SPACE, True, speed, turn_rate, motion, chipmunk)
        m.left[world] = space == IN_PYTHON
        waiting += m.left[world]
        if space > NO_SPACE:
            free_space(space, motion, chipmunk)
    return waiting
