"""A whole control period of the physics with its collision counts, in one call where compiled code calls Chipmunk.

`go_on` runs a world through its substeps. Where Python has to let robots touch, it stops before the step of pymunk, and
`land_and_go_on` continues.

Shapes: W worlds, N robots a world, R = W * N rows.
"""

from typing import Final

from clean_swarm_env.physics.chipmunk_calls import Chipmunk, free_space, make_space, open_chipmunk, touch
from clean_swarm_env.physics.collisions import Counts, count_world, open_counts
from clean_swarm_env.physics.drive import DriveState, open_drive, update_drives
from clean_swarm_env.physics.motion import RobotMotion, land, open_robot_motion, push, search_contacts, set_wanted
from selforg.arrays import Ints
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import lean_kernel, long_kernel
from selforg.compiler.records import Handle, Written
from selforg.walls.segments import Walls

NO_SPACE: Final = 0
"""In place of the address of a space: no robots have touched in this tick."""


@lean_kernel
def go_on(
    world: int,
    left: int,
    drive: Handle[DriveState],
    motion: Written[RobotMotion],
    counts: Written[Counts],
    walls: Handle[Walls],
    chipmunk: Handle[Chipmunk],
) -> int:
    """Run a world through its `left` substeps; return those left, of which Python has to run the first."""
    d, m, space = open_drive(drive), open_robot_motion(motion), NO_SPACE
    while left > 0:
        contact = search_contacts(world, m, open_counts(counts), walls)
        set_wanted(world, not contact, d.speed, d.turn_rate, m)
        if contact:
            push(world, m)
            if open_chipmunk(chipmunk).functions[0] == 0:
                return left
            if space == NO_SPACE:
                space = make_space(world, motion, walls, chipmunk)
            touch(world, space, left == 1, motion, chipmunk)
            land(world, motion, walls)
        count_world(world, m.positions, m.present, counts)
        left -= 1
    if space != NO_SPACE:
        free_space(space, motion, chipmunk)
    return 0


@long_kernel
def start_tick(
    now: float,
    rows: Ints,
    commands: Handle[Commanded],
    drive: Written[DriveState],
    motion: Written[RobotMotion],
    counts: Written[Counts],
    walls: Handle[Walls],
    chipmunk: Handle[Chipmunk],
) -> int:
    """Give the drives their commands at `now` [s] and run every world as far as compiled code can.

    Returns how many worlds have substeps left; a step, see `selforg.program`.
    """
    given, m, c = open_commanded(commands), open_robot_motion(motion), open_counts(counts)
    update_drives(given.vectors, given.commanded, given.in_place, m.headings, now, drive)
    for row in range(c.entered_in_tick.shape[0]):
        c.entered_in_tick[row] = 0
    waiting = 0
    for world in range(m.left.shape[0]):
        m.left[world] = go_on(world, m.substeps[0], drive, motion, counts, walls, chipmunk)
        waiting += m.left[world] > 0
    return waiting


@lean_kernel
def land_and_go_on(
    world: int,
    left: int,
    drive: Handle[DriveState],
    motion: Written[RobotMotion],
    counts: Written[Counts],
    walls: Handle[Walls],
    chipmunk: Handle[Chipmunk],
) -> int:
    """Continue a world after a substep that Python ran in pymunk; see `go_on`."""
    m = open_robot_motion(motion)
    land(world, motion, walls)
    count_world(world, m.positions, m.present, counts)
    return go_on(world, left - 1, drive, motion, counts, walls, chipmunk)
