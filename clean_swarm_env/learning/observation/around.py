"""What is around the robots: the record that all observation terms read.

Shapes: W worlds, N robots a world, R = W * N rows, K neighbour ranges, C coordinated goals, S sensors, B behaviours of
the robots' network.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import opening
from selforg.elementary import sine_cosine


class Around(NamedTuple):
    """Arrays of the worlds, settings, and arrays that are filled for every observation. Terms only read them."""

    robots: int  # N
    extent: Annotated[Floats, "2", READ]  # of the torus [m]
    positions: Annotated[Floats, "R 2", READ]  # of the robots [m]
    headings: Annotated[Floats, "R", READ]  # [rad]
    present: Annotated[Flags, "R", READ]  # whether there is a robot in the row
    working: Annotated[Flags, "R", READ]  # whether it is at work: others see nothing
    speed: Annotated[Floats, "R", READ]  # of the drive [m/s]
    turn_rate: Annotated[Floats, "R", READ]  # of the drive [rad/s]
    readings: Annotated[Floats, "R S", READ]  # of the robots' network
    marks: Annotated[Ints, "R LAYERS B", READ]  # of the robots' network, see `network.state`
    limits: Annotated[Ints, "W", READ]  # ticks after which each mission is over
    idle: Annotated[Ints, "R", READ]  # ticks since the robot last achieved something, see `Task.achievements`
    # settings
    first_options: Annotated[Ints, "C", READ]  # number of options of the goals before each goal
    ranges: Annotated[Floats, "K", READ]  # neighbour ranges, growing [m]
    longest: float  # half the diagonal of the torus [m]
    full_crowd: float  # number of robots in range that counts as 1
    patience: float  # time without progress that counts as 1 [ticks]
    reach: float  # of a robot's pose [m]
    max_speed: Annotated[Floats, "R", READ]  # [m/s]
    max_turn_rate: Annotated[Floats, "R", READ]  # [rad/s]
    fastest: float  # largest speed of any robot [m/s]
    avoidance: int  # column of the sensor of the avoidance vector's length, -1 without one
    avoiding: int  # number of the behaviour that avoids others, -1 without one
    # filled for every observation
    ticks: Annotated[Ints, "W", READ]  # since the reset of each world
    held: Annotated[Ints, "C R", READ]  # option that serves each goal
    # as the robot has heard: see `selforg.mechanisms.steering.base`
    neighbour: Annotated[Ints, "R", SCRATCH]  # row of the nearest other robot within the largest range, -1 without one
    heard: Annotated[Floats, "R OTHER", SCRATCH]  # what is known of it; its velocity is relative to that of the row
    within: Annotated[Ints, "R K", SCRATCH]  # number of other robots within each range
    others: Annotated[Floats, "N OTHER", SCRATCH]  # room for what a row knows of the others


open_around = opening(Around)


@inlined
def write_offset(heading: float, dx: float, dy: float, scale: float, way: Floats) -> float:
    """Write the way of a robot to what is (dx, dy) [m] from it into `way` (3,); return the distance [m].

    The way is the distance by `scale`, at most 1, then the unit vector there in the robot's frame.
    """
    length = float(np.sqrt(dx * dx + dy * dy))
    way[0], way[1], way[2] = min(length / scale, 1.0), 0.0, 0.0
    if length > 0.0:
        sine, cosine = sine_cosine(heading)
        way[1] = min(max((cosine * dx + sine * dy) / length, -1.0), 1.0)
        way[2] = min(max((cosine * dy - sine * dx) / length, -1.0), 1.0)
    return length
