"""A substep of the physics, and a whole control period with its collision counts in one call (compiled).

Substeps and counts of a period are those of `Physics.substep` and `CollisionCounter.count` in turn, in the same order
within each world.

Shapes: W worlds, N robots a world, R = W * N rows.
"""

from clean_swarm_env.physics.collisions import Counts, count_world, open_counts
from clean_swarm_env.physics.contacts import Contacts, open_contacts, solve
from clean_swarm_env.physics.drive import DriveState, Orders, open_drive, open_orders, steer_rows
from clean_swarm_env.physics.motion import RobotMotion, move_body, open_robot_motion, steer_body
from selforg.arrays import Floats
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Words


@inlined
def substep_world(
    world: int, speed: Floats, turn_rate: Floats, motion: Words[RobotMotion], contacts: Words[Contacts]
) -> None:
    """Run a substep of one world: robots take the velocities that they want, contacts change them, robots move."""
    m, c = open_robot_motion(motion), open_contacts(contacts)
    robots = m.positions.shape[0] // c.touching.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        if m.present[row]:
            steer_body(row, speed, turn_rate, m)
    in_contact = solve(world, motion, contacts)
    for row in range(world * robots, (world + 1) * robots):
        if not m.present[row]:
            continue
        vx, vy = m.velocities[row, 0], m.velocities[row, 1]
        if in_contact:
            vx, vy = vx + c.shifts[row, 0], vy + c.shifts[row, 1]
        move_body(row, vx, vy, m)


@lean_kernel
def substep_worlds(speed: Floats, turn_rate: Floats, motion: Words[RobotMotion], contacts: Words[Contacts]) -> None:
    """Run a substep of all worlds; speed (R,) [m/s] along the heading, turn_rate (R,) [rad/s]."""
    for world in range(open_contacts(contacts).touching.shape[0]):
        substep_world(world, speed, turn_rate, motion, contacts)


@lean_kernel
def run_period(
    now: float,
    substeps: int,
    orders: Words[Orders],
    drive: Words[DriveState],
    motion: Words[RobotMotion],
    contacts: Words[Contacts],
    counts: Words[Counts],
) -> None:
    """Give the drives their orders at `now` [s], run the substeps of all worlds and count after each."""
    o, d, m, c = open_orders(orders), open_drive(drive), open_robot_motion(motion), open_counts(counts)
    steer_rows(o.vectors, o.commanded, o.in_place, m.headings, now, drive)
    for row in range(c.entered_in_tick.shape[0]):
        c.entered_in_tick[row] = 0
    worlds = c.samples.shape[0]
    robots = m.positions.shape[0] // worlds
    for world in range(worlds):
        for _ in range(substeps):
            substep_world(world, d.speed, d.turn_rate, motion, contacts)
            count_world(world, m.positions, m.present, counts)
            for row in range(world * robots, (world + 1) * robots):
                c.entered_in_tick[row] += c.entered[row]
