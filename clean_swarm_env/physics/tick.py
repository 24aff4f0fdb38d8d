"""A whole control period of the physics with its collision counts, in as few calls as contacts allow (compiled).

`go_on` runs a world through its substeps and calls Chipmunk while robots touch. It stops where bodies need other seam
copies, or where the world has no space yet. Then Python updates pymunk and runs one substep, and `settle_and_go_on`
continues. Substeps and counts are those of `Physics.substep` and `CollisionCounter.count` in turn, in the same order
within each world.

Shapes: W worlds, N robots a world, R = W * N rows.
"""

from clean_swarm_env.physics.chipmunk_calls import SPACE, touch
from clean_swarm_env.physics.collisions import Counts, count_world, open_counts
from clean_swarm_env.physics.drive import DriveState, Orders, open_drive, open_orders, steer_rows
from clean_swarm_env.physics.motion import RobotMotion, land, open_robot_motion, push, search_contacts, steer_world
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Words


@inlined
def count(world: int, motion: Words[RobotMotion], counts: Words[Counts]) -> None:
    """Count one world and add the events to those of the tick."""
    m, c = open_robot_motion(motion), open_counts(counts)
    count_world(world, m.positions, m.present, counts)
    robots = m.positions.shape[0] // m.patience.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        c.entered_in_tick[row] += c.entered[row]


@inlined
def can_touch(world: int, m: RobotMotion) -> bool:
    """Return whether Chipmunk can be called for the next substep of a world: it has a space with the right copies."""
    robots = m.copies.shape[0] // m.handles.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        if m.copies[row] != m.copied[row]:
            return False
    return bool(m.handles[world, SPACE] != 0)


@lean_kernel
def settle(world: int, motion: Words[RobotMotion]) -> None:
    """Move the robots of a world by the velocities after a substep of pymunk."""
    m = open_robot_motion(motion)
    crossed = land(world, motion)
    # Crossing a seam moves the body by a world size, and free motion moves it without pymunk: load it anew then.
    m.current[world] = not crossed and m.patience[world] > 1


@lean_kernel
def go_on(world: int, left: int, drive: Words[DriveState], motion: Words[RobotMotion], counts: Words[Counts]) -> int:
    """Run a world through its `left` substeps; return those left, of which Python has to run the first."""
    m, d = open_robot_motion(motion), open_drive(drive)
    while left > 0:
        contact = search_contacts(world, m)
        steer_world(world, not contact, d.speed, d.turn_rate, m)
        if contact:
            push(world, motion)
            if not can_touch(world, m):
                return left
            touch(world, m.handles, bool(m.current[world]), m.timestep)
            settle(world, motion)
        count(world, motion, counts)
        left -= 1
    return 0


@lean_kernel
def begin_tick(
    now: float,
    substeps: int,
    orders: Words[Orders],
    drive: Words[DriveState],
    motion: Words[RobotMotion],
    counts: Words[Counts],
) -> int:
    """Give the drives their orders at `now` [s] and run every world as far as compiled code can.

    Returns how many worlds have substeps left.
    """
    o, m, c = open_orders(orders), open_robot_motion(motion), open_counts(counts)
    steer_rows(o.vectors, o.commanded, o.in_place, m.headings, now, drive)
    for row in range(c.entered_in_tick.shape[0]):
        c.entered_in_tick[row] = 0
    waiting = 0
    for world in range(m.left.shape[0]):
        m.left[world] = go_on(world, substeps, drive, motion, counts)
        waiting += m.left[world] > 0
    return waiting


@lean_kernel
def settle_and_go_on(
    world: int, left: int, drive: Words[DriveState], motion: Words[RobotMotion], counts: Words[Counts]
) -> int:
    """Continue a world after a substep that Python ran in pymunk; see `go_on`."""
    settle(world, motion)
    count(world, motion, counts)
    return go_on(world, left - 1, drive, motion, counts)
