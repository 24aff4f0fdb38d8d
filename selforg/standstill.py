"""For how long robots have not got on; who turns or goes in circles stands still, too."""

from __future__ import annotations

from typing import Final

import numpy as np

from selforg.arrays import Floats, Ints, Lasting
from selforg.compiler.decorators import lean_kernel
from selforg.space import Space, nearest_image

GOT_ON_BEYOND: Final = 0.5
"""Radius of the circle that a robot that gets on leaves [m]."""


class Standstill:
    """For how long each of R robots in the plane has not got on.

    At the beginning a robot is taken to come from the origin, so that it waits from its first tick on.

    Attributes:
        waited: (R,) int64, ticks since it got on; the same array all the time.

    >>> from selforg.space import Torus
    >>> standstill = Standstill(1, Torus(10.0, 10.0))
    >>> for x in (0.2, 9.9, 1.0, 1.1):
    ...     standstill.note(np.array([[x, 0.0]]))
    ...     print(standstill.waited)
    [1]
    [2]
    [0]
    [1]

    """

    def __init__(self, rows: int, space: Space) -> None:
        self._extent = space.extent
        self._places: Floats = np.zeros((rows, 2))
        self.waited: Ints = np.zeros(rows, dtype=np.int64)

    def note(self, positions: Floats) -> None:
        """Note the `positions` (R, 2) [m] of a tick."""
        note_rows(positions, self._extent, self._places, self.waited)

    def reset(self, rows: Ints) -> None:
        """Begin anew in `rows` (K,)."""
        self._places[rows] = 0.0
        self.waited[rows] = 0

    def lasting(self) -> Lasting:
        """Return what robots hand on to the next tick."""
        return Lasting((self._places, self.waited))


@lean_kernel
def note_rows(positions: Floats, extent: Floats, places: Floats, waited: Ints) -> None:
    """Count in `waited` (R,) the ticks since rows left their circles about `places` (R, 2), or move these along."""
    for row in range(positions.shape[0]):
        x = nearest_image(positions[row, 0] - places[row, 0], extent[0])
        y = nearest_image(positions[row, 1] - places[row, 1], extent[1])
        if x * x + y * y > GOT_ON_BEYOND * GOT_ON_BEYOND:
            places[row, 0], places[row, 1] = positions[row, 0], positions[row, 1]
            waited[row] = 0
        else:
            waited[row] += 1
