"""Free motion on the torus: what robots do as long as nobody touches (compiled, all worlds at once).

Shapes: W worlds, N robots a world, R = W * N rows; world w has the rows w*N .. (w+1)*N - 1. A body row is
(x, y, vx, vy) [m, m/s]: where the last substep began, and the velocity it moved with.
"""

from typing import Final

import numpy as np

from selforg.compiler.decorators import inlined, lean_kernel

ALONE: Final = 0  # contact search of `fly`: nobody ever touches
PAIRS: Final = 1  # look at every pair of a world
ALWAYS: Final = 2  # take every world to be in contact

COPY_RIGHT: Final = 1  # seam copies of a body, one bit each: at (+width, 0),
COPY_ABOVE: Final = 2  # at (0, +height),
COPY_RIGHT_ABOVE: Final = 4  # at (+width, +height),
COPY_RIGHT_BELOW: Final = 8  # at (+width, -height)


@inlined
def wrapped(coordinate: float, size: float) -> float:
    """Coordinate on a circle [m] -> the same place in [0, size)."""
    if 0.0 <= coordinate < size:
        return coordinate
    inside = coordinate - size * np.floor(coordinate / size)
    # A tiny negative number plus the size rounds to the size itself, which is the place 0.
    return 0.0 if inside >= size else inside


@inlined
def shorter_way(offset: float, size: float) -> float:
    """Difference of two coordinates in [0, size) [m] -> the same difference the shorter way round."""
    if offset > 0.5 * size:
        return offset - size
    if offset < -0.5 * size:
        return offset + size
    return offset


@inlined
def wrapped_angle(angle: float) -> float:
    """Angle [rad] -> the same direction in (-pi, pi]."""
    if -np.pi < angle <= np.pi:
        return angle
    inside = angle - 2.0 * np.pi * np.ceil((angle - np.pi) / (2.0 * np.pi))
    return np.pi if inside <= -np.pi else inside


@inlined
def touching(
    positions: np.ndarray, present: np.ndarray, first: int, end: int, width: float, height: float, reach: float
) -> bool:
    """Is any pair of the rows first .. end - 1 that are present (R,) closer than `reach` [m]? positions (R, 2) [m]."""
    for i in range(first, end):
        if not present[i]:
            continue
        for j in range(first, i):
            if not present[j]:
                continue
            dx = shorter_way(positions[i, 0] - positions[j, 0], width)
            if abs(dx) < reach:
                dy = shorter_way(positions[i, 1] - positions[j, 1], height)
                if dx * dx + dy * dy < reach * reach:
                    return True
    return False


@inlined
def move(positions: np.ndarray, bodies: np.ndarray, row: int, width: float, height: float, timestep: float) -> bool:
    """Let a body row move on for one timestep [s]; True if it crossed a seam.

    positions (R, 2) [m] gets the new place; the start in bodies (R, 4) is shifted along when the place wraps, so
    that start + velocity * timestep is the new place without another wrap.
    """
    x = bodies[row, 0] + bodies[row, 2] * timestep
    y = bodies[row, 1] + bodies[row, 3] * timestep
    positions[row, 0] = wrapped(x, width)
    positions[row, 1] = wrapped(y, height)
    if positions[row, 0] == x and positions[row, 1] == y:
        return False
    bodies[row, 0] += positions[row, 0] - x
    bodies[row, 1] += positions[row, 1] - y
    return True


@inlined
def search_contacts(
    world: int, positions: np.ndarray, present: np.ndarray, patience: np.ndarray, search: int, width: float,
    height: float, reach: float, settling: int,
) -> bool:  # fmt: skip
    """Set the patience (W,) of a world for the substep that begins; returns whether it is in contact."""
    robots = positions.shape[0] // patience.shape[0]
    first = world * robots
    if search == ALWAYS or (
        search == PAIRS and touching(positions, present, first, first + robots, width, height, reach)
    ):
        patience[world] = settling
    elif patience[world] > 0:
        patience[world] -= 1
    return bool(patience[world] > 0)


@inlined
def steer_world(
    first: int, end: int, free: bool, positions: np.ndarray, headings: np.ndarray, bodies: np.ndarray,
    wanted: np.ndarray, present: np.ndarray, speed: np.ndarray, turn_rate: np.ndarray, width: float, height: float,
    timestep: float,
) -> None:  # fmt: skip
    """Take up what the rows first .. end - 1 want in this substep, turn them and, where `free`, move them."""
    for row in range(first, end):
        if not present[row]:
            continue
        wanted[row, 0] = speed[row] * np.cos(headings[row])
        wanted[row, 1] = speed[row] * np.sin(headings[row])
        headings[row] = wrapped_angle(headings[row] + turn_rate[row] * timestep)
        if free:
            bodies[row, 0], bodies[row, 1] = positions[row, 0], positions[row, 1]
            bodies[row, 2], bodies[row, 3] = wanted[row, 0], wanted[row, 1]
            move(positions, bodies, row, width, height, timestep)


@lean_kernel
def fly(
    positions: np.ndarray, headings: np.ndarray, bodies: np.ndarray, wanted: np.ndarray, present: np.ndarray,
    patience: np.ndarray, speed: np.ndarray, turn_rate: np.ndarray, search: int, width: float, height: float,
    reach: float, timestep: float, settling: int,
) -> int:  # fmt: skip
    """One substep of every world that is free of contacts; returns the number of the others.

    positions (R, 2) [m], headings (R,) [rad] and bodies (R, 4) are updated in place, headings of all worlds;
    wanted (R, 2) [m/s] gets speed (R,) [m/s] along the heading at the beginning of the substep;
    present (R,) bool: rows that are not stay as they are;
    patience (W,) counts down from `settling` since the last contact: a world is free at 0.
    """
    robots = positions.shape[0] // patience.shape[0]
    engaged = 0
    for world in range(patience.shape[0]):
        contact = search_contacts(world, positions, present, patience, search, width, height, reach, settling)
        steer_world(
            world * robots, (world + 1) * robots, not contact, positions, headings, bodies, wanted, present, speed,
            turn_rate, width, height, timestep,
        )  # fmt: skip
        engaged += contact
    return engaged


@lean_kernel
def push(
    forces: np.ndarray,
    copies: np.ndarray,
    positions: np.ndarray,
    bodies: np.ndarray,
    wanted: np.ndarray,
    present: np.ndarray,
    first: int,
    end: int,
    height: float,
    zone: float,
    stiffness: float,
) -> None:
    """Set forces and seam copies for the rows first .. end - 1 of one world in contact.

    forces (R, 2) [N] = stiffness [kg/s] * (wanted (R, 2) - velocity): the force that gives the wanted velocity in
    one timestep. copies (R,) uint8 names, bit by bit, the copies that a body within `zone` [m] of a seam needs, if it
    is present (R,) at all.
    """
    for row in range(first, end):
        forces[row, 0] = stiffness * (wanted[row, 0] - bodies[row, 2])
        forces[row, 1] = stiffness * (wanted[row, 1] - bodies[row, 3])
        needed = 0
        if not present[row]:
            copies[row] = needed
            continue
        if positions[row, 0] < zone:
            needed |= COPY_RIGHT
            if positions[row, 1] < zone:
                needed |= COPY_RIGHT_ABOVE
            if positions[row, 1] > height - zone:
                needed |= COPY_RIGHT_BELOW
        if positions[row, 1] < zone:
            needed |= COPY_ABOVE
        copies[row] = needed


@lean_kernel
def land(
    positions: np.ndarray, bodies: np.ndarray, first: int, end: int, width: float, height: float, timestep: float
) -> bool:
    """Move the rows first .. end - 1 on with the velocities that the contacts left; True if any crossed a seam."""
    crossed = False
    for row in range(first, end):
        if move(positions, bodies, row, width, height, timestep):
            crossed = True
    return crossed
