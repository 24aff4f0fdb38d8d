"""Zones of the ground in which messages are lost or robots are slow: rectangles, of which the worst counts."""

from typing import Annotated

import numpy as np

from selforg.arrays import READ, Floats
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Handle


class Zones:
    """The zones of all worlds of a batch.

    corners: (Z, 4) x and y of the lower left corner, then of the upper right one [m].
    losses: (Z,) probability that a message from or to a robot inside gets lost.
    speeds: (Z,) share of its largest speed that a robot has inside.

    >>> zones = Zones(np.array([[0.0, 0.0, 2.0, 2.0]]), np.array([0.9]), np.array([1.0]))
    >>> zones.silent, zones.slow
    (True, False)
    """

    corners: Annotated[Floats, "Z 4", READ]
    losses: Annotated[Floats, "Z", READ]
    speeds: Annotated[Floats, "Z", READ]

    def __init__(self, corners: Floats, losses: Floats, speeds: Floats) -> None:
        self.corners, self.losses, self.speeds = corners, losses, speeds
        self.silent, self.slow = bool((losses > 0.0).any()), bool((speeds < 1.0).any())


@inlined
def is_inside(row: int, zone: int, positions: Floats, corners: Floats) -> bool:
    """Return whether a robot is in a zone."""
    x, y = positions[row, 0], positions[row, 1]
    inside = corners[zone, 0] <= x <= corners[zone, 2] and corners[zone, 1] <= y <= corners[zone, 3]
    return bool(inside)


@lean_kernel
def write_losses(positions: Floats, corners: Floats, given: Floats, losses: Floats) -> None:
    """Write the probability that a message from or to each robot at `positions` (R, 2) [m] gets lost.

    It is the largest one `given` for the zones in which the robot is.
    """
    for row in range(positions.shape[0]):
        losses[row] = 0.0
        for zone in range(corners.shape[0]):
            if is_inside(row, zone, positions, corners):
                losses[row] = max(losses[row], given[zone])


@lean_kernel
def slow_down(
    commands: Handle[Commanded], positions: Floats, max_speed: Floats, corners: Floats, speeds: Floats
) -> None:
    """Shorten the commands to robots at `positions` (R, 2) [m] by the slowest zone around; max_speed (R,) [m/s]."""
    given = open_commanded(commands)
    for row in range(positions.shape[0]):
        share = 1.0
        for zone in range(corners.shape[0]):
            if given.commanded[row] and is_inside(row, zone, positions, corners):
                share = min(share, speeds[zone])
        x, y = given.vectors[row, 0], given.vectors[row, 1]
        length = np.sqrt(x * x + y * y)
        if share < 1.0 and length > 0.0:
            scale = share * min(length, max_speed[row]) / length
            given.vectors[row, 0], given.vectors[row, 1] = scale * x, scale * y
