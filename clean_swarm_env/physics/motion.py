"""Motion on the torus (compiled): free while no robot touches another or a wall, else as far as contacts may push.

Shapes: W worlds, N robots a world, R = W * N rows; world w has the rows w*N .. (w+1)*N - 1.
"""

from typing import Annotated, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from clean_swarm_env.physics.cells import NOBODY, cell_at, cell_beside, fill_cells
from clean_swarm_env.physics.collisions import Counts, list_holds
from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Handle, Written, opening
from selforg.elementary import sine_cosine
from selforg.space import nearest_image, wrapped
from selforg.walls.segments import Walls, cell_of_walls, open_walls, to_segment, touches_wall

NOBODY_TOUCHES: Final = 0  # search for contacts: robots never touch
SEARCH_PAIRS: Final = 1  # look at every pair of a world
ALWAYS_TOUCHING: Final = 2  # treat every world as in contact

SKIN: Final = 1e-9  # share of the radius added: robots exactly two radii apart touch in spite of rounding
PERSISTENCE: Final = 3  # [substeps] for which Chipmunk remembers a contact

LONGEST_WAY: Final = 0.5  # way of a body that contacts push, in a substep [its radius]
DEEPEST: Final = 0.6  # how far contacts push a body into a wall [its radius]
CLOSEST: Final = 0.25  # how close contacts push two centres [sum of both radii]

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
    substeps: Annotated[Ints, "1", READ]  # of a tick
    extent: Annotated[Floats, "2", READ]  # of the torus [m], as `physics.cells` takes it
    cells: Annotated[Ints, "lines columns", SCRATCH]  # see `cells`; a single one where cells save no time
    links: Annotated[Ints, "N", SCRATCH]  # see `cells`
    search: int  # NOBODY_TOUCHES, SEARCH_PAIRS or ALWAYS_TOUCHING
    width: float  # of the torus [m]
    height: float  # [m]
    radii: Annotated[Floats, "R", READ]  # of the discs in Chipmunk [m]
    reach: float  # distance of two centres below which the largest robots touch [m]
    zone: float  # distance from a seam within which a body needs copies [m]
    timestep: float  # [s]
    settling: int  # substeps for which a world is in contact from a touch on, that of the touch included
    stiffness: float  # force by missing velocity [kg/s]; a robot has 1 kg, because their mass has no effect


open_robot_motion = opening(RobotMotion)


@inlined
def wrapped_angle(angle: float) -> float:
    """Return the direction of an angle [rad] in (-pi, pi]."""
    if -np.pi < angle <= np.pi:
        return angle
    inside = angle - 2.0 * np.pi * np.ceil((angle - np.pi) / (2.0 * np.pi))
    return np.pi if inside <= -np.pi else inside


@inlined
def touch_each_other(i: int, j: int, m: RobotMotion) -> bool:
    """Return whether the robots in two rows are present and touch."""
    dx = nearest_image(m.positions[i, 0] - m.positions[j, 0], m.width)
    if abs(dx) >= m.reach or not m.present[i] or not m.present[j]:
        return False
    dy = nearest_image(m.positions[i, 1] - m.positions[j, 1], m.height)
    both = m.radii[i] + m.radii[j]
    return bool(dx * dx + dy * dy < both * both)


@inlined
def touching(world: int, first: int, end: int, m: RobotMotion, c: Counts) -> bool:
    """Return whether any two robots of a world, in the rows first .. end - 1, touch; looks at listed pairs only."""
    if c.furthest >= m.reach * m.reach and list_holds(world, m.positions, m.present, c):
        for index in range(c.listed[world]):
            if touch_each_other(c.pairs[world, index, 0], c.pairs[world, index, 1], m):
                return True
        return False
    for i in range(first, end):
        for j in range(first, i):
            if touch_each_other(i, j, m):
                return True
    return False


@inlined
def touching_walls(first: int, end: int, m: RobotMotion, walls: Handle[Walls]) -> bool:
    """Return whether any robot present in the rows first .. end - 1 touches a wall."""
    for row in range(first, end):
        if m.present[row] and touches_wall(m.positions[row, 0], m.positions[row, 1], m.radii[row], walls):
            return True
    return False


@lean_kernel
def choose_walls(world: int, motion: Handle[RobotMotion], walls: Handle[Walls]) -> None:
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
def search_contacts(world: int, m: RobotMotion, c: Counts, walls: Handle[Walls]) -> bool:
    """Set the patience of a world for the substep that begins; return whether it is in contact."""
    robots = m.parts.shape[0]
    first = world * robots
    if (
        m.search == ALWAYS_TOUCHING
        or (m.search == SEARCH_PAIRS and touching(world, first, first + robots, m, c))
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


@inlined
def leads_to_wall(row: int, wx: float, wy: float, m: RobotMotion, walls: Handle[Walls]) -> bool:
    """Return whether a robot's way [m] ends deeper in a wall than DEEPEST, and deeper than the robot is."""
    w, least = open_walls(walls), (1.0 - DEEPEST) * m.radii[row]
    x, y = wrapped(m.positions[row, 0] + wx, m.width), wrapped(m.positions[row, 1] + wy, m.height)
    cell = cell_of_walls(x, y, w)
    if cell < 0 or w.clear[cell] >= least:
        return False
    for k in range(w.first[cell], w.first[cell + 1]):
        dx, dy = to_segment(x, y, w.listed[k], w)
        bx, by = to_segment(x - wx, y - wy, w.listed[k], w)
        if dx * dx + dy * dy < min(least * least, bx * bx + by * by):
            return True
    return False


@inlined
def leads_to_robot(row: int, first: int, wx: float, wy: float, m: RobotMotion) -> bool:
    """Return whether a robot's way [m] ends closer to another than CLOSEST, and closer than the robot is.

    first: first row of its world, whose robots are in the cells.
    """
    lines, columns = m.cells.shape
    line, column = cell_at(m.positions[row, 1], lines, m.height), cell_at(m.positions[row, 0], columns, m.width)
    for walk in range(min(lines * columns, 9)):
        point = cell_beside(line, column, walk, m.cells)
        while point != NOBODY:
            least = CLOSEST * (m.radii[row] + m.radii[first + point])
            x = nearest_image(m.positions[row, 0] - m.positions[first + point, 0], m.width)
            y = nearest_image(m.positions[row, 1] - m.positions[first + point, 1], m.height)
            if (x + wx) ** 2 + (y + wy) ** 2 < min(least * least, x * x + y * y):
                return True
            point = m.links[point]
    return False


@inlined
def hold_back(row: int, first: int, m: RobotMotion, walls: Handle[Walls]) -> None:
    """Shorten the way of a body that contacts push too far, and let it stay where it would sink too deep.

    Chipmunk looks at where bodies are, not at their way, and gives way to crowds. Each body in turn keeps the bounds,
    so none gets through a wall or another body.
    """
    wx = m.bodies[row, 0] + m.bodies[row, 2] * m.timestep - m.positions[row, 0]
    wy = m.bodies[row, 1] + m.bodies[row, 3] * m.timestep - m.positions[row, 1]
    px, py = wx - m.wanted[row, 0] * m.timestep, wy - m.wanted[row, 1] * m.timestep
    if px * px + py * py < (SKIN * m.radii[row]) ** 2:
        return  # nothing pushes it
    share = min(LONGEST_WAY * m.radii[row] / max(np.sqrt(wx * wx + wy * wy), 1e-300), 1.0)
    wx, wy = share * wx, share * wy
    if leads_to_wall(row, wx, wy, m, walls) or (m.search != NOBODY_TOUCHES and leads_to_robot(row, first, wx, wy, m)):
        share = wx = wy = 0.0
    if share < 1.0:
        m.bodies[row, 0], m.bodies[row, 1] = m.positions[row, 0], m.positions[row, 1]
        m.bodies[row, 2], m.bodies[row, 3] = wx / m.timestep, wy / m.timestep


@lean_kernel
def land(world: int, motion: Written[RobotMotion], walls: Handle[Walls]) -> None:
    """Move the robots of a world by their velocities after the contacts, as far as that is possible."""
    m = open_robot_motion(motion)
    robots = m.parts.shape[0]
    first = world * robots
    fill_cells(m.positions, first, m.present[first : first + robots], m.extent, m.cells, m.links)
    for row in range(first, first + robots):
        hold_back(row, first, m, walls)
        move(row, m)
