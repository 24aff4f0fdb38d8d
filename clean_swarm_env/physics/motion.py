"""Motion on the torus: velocities that robots want, and moves by the velocities that they have (compiled).

Shapes: W worlds, N robots a world, R = W * N rows; world w has the rows w*N .. (w+1)*N - 1.
"""

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import Flags, Floats
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Recording
from selforg.space import wrapped


class RobotMotion(NamedTuple):
    """The bodies of all worlds, and the torus on which they move."""

    positions: Annotated[Floats, "R 2"]  # in [0, width) x [0, height) [m]
    headings: Annotated[Floats, "R"]  # in (-pi, pi] [rad]
    velocities: Annotated[Floats, "R 2"]  # after contacts [m/s]
    present: Annotated[Flags, "R"]  # robots that are not there touch nobody and do not move
    extent: Annotated[Floats, "2"]  # width and height, as `physics.cells` takes them [m]
    width: float  # of the torus [m]
    height: float  # [m]
    timestep: float  # [s]


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
def steer_body(row: int, speed: Floats, turn_rate: Floats, m: RobotMotion) -> None:
    """Give a robot the velocity that it wants, along the heading that it has, and then turn it."""
    m.velocities[row, 0] = speed[row] * np.cos(m.headings[row])
    m.velocities[row, 1] = speed[row] * np.sin(m.headings[row])
    m.headings[row] = wrapped_angle(m.headings[row] + turn_rate[row] * m.timestep)


@inlined
def move_body(row: int, vx: float, vy: float, m: RobotMotion) -> None:
    """Move a robot by a velocity [m/s] for one timestep."""
    m.positions[row, 0] = wrapped(m.positions[row, 0] + vx * m.timestep, m.width)
    m.positions[row, 1] = wrapped(m.positions[row, 1] + vy * m.timestep, m.height)
