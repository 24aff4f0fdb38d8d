"""Free motion on the torus: how robots move as long as none touches another or a wall (compiled, all worlds at once).

Shapes: W worlds, N robots a world, R = W * N rows; world w has the rows w*N .. (w+1)*N - 1.
"""

from typing import Annotated, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Recording, Words, Written
from selforg.elementary import sine_cosine
from selforg.space import nearest_image, wrapped
from selforg.walls.segments import Walls, cell_of_walls, open_walls, touches_wall

NOBODY_TOUCHES: Final = 0  # search for contacts: robots never touch
SEARCH_PAIRS: Final = 1  # look at every pair of a world
ALWAYS_TOUCHING: Final = 2  # treat every world as in contact

SKIN: Final = 1e-9  # share of the radius added: robots exactly two radii apart touch in spite of rounding
PERSISTENCE: Final = 3  # [substeps] for which Chipmunk remembers a contact

COPY_RIGHT, COPY_ABOVE, COPY_RIGHT_ABOVE, COPY_RIGHT_BELOW = 1, 2, 4, 8  # seam copies of a body, one bit each
COPY_OFFSETS: Final = ((1, 0), (0, 1), (1, 1), (1, -1))  # their places [world sizes], in the order of the bits
NEAR_ROBOTS: Final = 1  # in place of the address of a wall that robots may touch in this tick
PARTS: Final = 2 + len(COPY_OFFSETS)  # of a robot in Chipmunk: a body, its circle and the seam copies of the circle


class RobotMotion(NamedTuple):
    """The bodies of all worlds, and the sizes that their motion depends on."""

    positions: Annotated[Floats, "R 2", KEPT]  # in [0, width) x [0, height) [m]
    headings: Annotated[Floats, "R", KEPT]  # in (-pi, pi] [rad]
    bodies: Annotated[Floats, "R 4", KEPT]  # x, y where the last substep began [m], and its velocity vx, vy [m/s]
    wanted: Annotated[Floats, "R 2", KEPT]  # velocity that each robot wants [m/s]
    forces: Annotated[Floats, "R 2", SCRATCH]  # [N]
    present: Annotated[Flags, "R", READ]  # robots that are not there touch nobody and do not move
    copies: Annotated[npt.NDArray[np.uint8], "R", SCRATCH]  # seam copies that each body needs
    patience: Annotated[Ints, "W", KEPT]  # substeps until a world is free of contacts
    parts: Annotated[Ints, "N PARTS", SCRATCH]  # addresses in Chipmunk while a world is in contact, else 0
    walls: Annotated[Ints, "K", SCRATCH]  # likewise, of segments; NEAR_ROBOTS where one is to be put there
    left: Annotated[Ints, "W", SCRATCH]  # substeps of the running tick that a world still has to do
    search: int  # NOBODY_TOUCHES, SEARCH_PAIRS or ALWAYS_TOUCHING
    width: float  # of the torus [m]
    height: float  # [m]
    radii: Annotated[Floats, "R", READ]  # of the discs in Chipmunk [m]
    reach: float  # distance of two centres below which the largest robots touch [m]
    zone: float  # distance from a seam within which a body needs copies [m]
    timestep: float  # [s]
    settling: int  # substeps for which a world is in contact from a touch on, that of the touch included
    stiffness: float  # force by missing velocity [kg/s]; a robot has 1 kg, because their mass has no effect


ROBOT_MOTION = Recording(RobotMotion)
open_robot_motion = ROBOT_MOTION.open


@inlined
def wrapped_angle(angle: float) -> float:
    """Return the direction of an angle [rad] in (-pi, pi]."""
    if -np.pi < angle <= np.pi:
        return angle
    inside = angle - 2.0 * np.pi * np.ceil((angle - np.pi) / (2.0 * np.pi))
    return np.pi if inside <= -np.pi else inside


@inlined
def touching(first: int, end: int, m: RobotMotion) -> bool:
    """Return whether any two robots present in the rows first .. end - 1 touch."""
    for i in range(first, end):
        if not m.present[i]:
            continue
        for j in range(first, i):
            if not m.present[j]:
                continue
            dx = nearest_image(m.positions[i, 0] - m.positions[j, 0], m.width)
            if abs(dx) < m.reach:
                dy = nearest_image(m.positions[i, 1] - m.positions[j, 1], m.height)
                both = m.radii[i] + m.radii[j]
                if dx * dx + dy * dy < both * both:
                    return True
    return False


@inlined
def touching_walls(first: int, end: int, m: RobotMotion, walls: Words[Walls]) -> bool:
    """Return whether any robot present in the rows first .. end - 1 touches a wall."""
    for row in range(first, end):
        if m.present[row] and touches_wall(m.positions[row, 0], m.positions[row, 1], m.radii[row], walls):
            return True
    return False


@lean_kernel
def choose_walls(world: int, motion: Words[RobotMotion], walls: Words[Walls]) -> None:
    """Write NEAR_ROBOTS for each wall that a robot of a world may touch in this tick, else 0."""
    m, w = open_robot_motion(motion), open_walls(walls)
    robots = m.parts.shape[0]
    for k in range(m.walls.shape[0]):
        m.walls[k] = 0
    for row in range(world * robots, (world + 1) * robots):
        cell = cell_of_walls(m.positions[row, 0], m.positions[row, 1], w)
        if cell >= 0 and m.present[row]:
            for k in range(w.first[cell], w.first[cell + 1]):
                m.walls[w.listed[k]] = NEAR_ROBOTS


@inlined
def move(row: int, m: RobotMotion) -> None:
    """Move a body for one timestep.

    Where the new place is wrapped, the start of the substep is shifted by the same world size. So start + velocity *
    timestep is the new place without another wrap.
    """
    x = m.bodies[row, 0] + m.bodies[row, 2] * m.timestep
    y = m.bodies[row, 1] + m.bodies[row, 3] * m.timestep
    m.positions[row, 0] = wrapped(x, m.width)
    m.positions[row, 1] = wrapped(y, m.height)
    if m.positions[row, 0] != x or m.positions[row, 1] != y:
        m.bodies[row, 0] += m.positions[row, 0] - x
        m.bodies[row, 1] += m.positions[row, 1] - y


@inlined
def search_contacts(world: int, m: RobotMotion, walls: Words[Walls]) -> bool:
    """Set the patience of a world for the substep that begins; return whether it is in contact."""
    robots = m.parts.shape[0]
    first = world * robots
    if (
        m.search == ALWAYS_TOUCHING
        or (m.search == SEARCH_PAIRS and touching(first, first + robots, m))
        or (m.walls.shape[0] > 0 and touching_walls(first, first + robots, m, walls))
    ):
        m.patience[world] = m.settling
    elif m.patience[world] > 0:
        m.patience[world] -= 1
    return bool(m.patience[world] > 0)


@inlined
def set_wanted(world: int, free: bool, speed: Floats, turn_rate: Floats, m: RobotMotion) -> None:
    """Set the velocity that each robot of a world wants in this substep, turn robots and, where `free`, move them."""
    robots = m.parts.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        if not m.present[row]:
            continue
        sine, cosine = sine_cosine(m.headings[row])
        m.wanted[row, 0], m.wanted[row, 1] = speed[row] * cosine, speed[row] * sine
        m.headings[row] = wrapped_angle(m.headings[row] + turn_rate[row] * m.timestep)
        if free:
            m.bodies[row, 0], m.bodies[row, 1] = m.positions[row, 0], m.positions[row, 1]
            m.bodies[row, 2], m.bodies[row, 3] = m.wanted[row, 0], m.wanted[row, 1]
            move(row, m)


@inlined
def push(world: int, m: RobotMotion) -> None:
    """Set forces and seam copies of a world in contact.

    The force gives the wanted velocity in one timestep. A present body within `zone` of a seam needs copies.
    """
    robots = m.parts.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        m.forces[row, 0] = m.stiffness * (m.wanted[row, 0] - m.bodies[row, 2])
        m.forces[row, 1] = m.stiffness * (m.wanted[row, 1] - m.bodies[row, 3])
        needed = 0
        if not m.present[row]:
            m.copies[row] = needed
            continue
        if m.positions[row, 0] < m.zone:
            needed |= COPY_RIGHT
            if m.positions[row, 1] < m.zone:
                needed |= COPY_RIGHT_ABOVE
            if m.positions[row, 1] > m.height - m.zone:
                needed |= COPY_RIGHT_BELOW
        if m.positions[row, 1] < m.zone:
            needed |= COPY_ABOVE
        m.copies[row] = needed


@lean_kernel
def land(world: int, motion: Written[RobotMotion]) -> None:
    """Move the robots of a world by their velocities after the contacts."""
    m = open_robot_motion(motion)
    robots = m.parts.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        move(row, m)
