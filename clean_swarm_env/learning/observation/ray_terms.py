"""A term of distances along rays: a lidar."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from selforg.arrays import Floats, Ints
from selforg.components.sensors import check_rays


@TERMS.register
class LidarTerm(Term):
    """How far each ray from the middle of the robot goes to the first wall, robot or thing, by `farthest` [m].

    Ray 0 points ahead, and the others follow to the left, evenly all around. A ray that meets nothing is 1. Items and
    stations count as discs of radius `things` [m], other things as at least so large; 0: rays meet none of them.
    """

    name = "lidar"

    def __init__(self, observed: Observed, *, rays: float = 16.0, farthest: float = 4.0, things: float = 0.1) -> None:
        super().__init__(observed)
        check_rays("terms: lidar", rays, farthest, things)
        self.components = tuple(f"lidar_{ray}" for ray in range(int(rays)))
        self._farthest = float(farthest)
        angles: Floats = 2.0 * np.pi * np.arange(int(rays), dtype=np.float64) / rays
        self._cast = observed.worlds.minds.surroundings.rays(angles, self._farthest, float(things))

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the lengths of the rays."""
        out[:, rows] = self._cast(rows).T / self._farthest
