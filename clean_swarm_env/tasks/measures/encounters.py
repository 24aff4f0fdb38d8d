"""Counts of robots that run into things that do not move."""

import numpy as np

from clean_swarm_env.world.ground import Ground
from selforg.arrays import Flags, Floats, Ints


class Bumps:
    """Counts of robots that come closer to the middle of a thing than `distance` [m].

    Attributes:
        events: (W,) so far. A robot that is close at the first look does not count.

    """

    def __init__(self, things: Floats, distance: float, ground: Ground) -> None:
        self._things, self._distance, self._ground = things, distance, ground  # things (W, M, 2) [m]
        self.events: Ints = np.zeros(len(things), dtype=np.int64)
        self._before: Flags | None = None

    def look(self, positions: Floats) -> None:
        """Look once at robots at positions (W, N, 2) [m]."""
        touching = self._ground.distances(positions[:, :, None], self._things[:, None]) < self._distance
        if self._before is not None:
            self.events += (touching & ~self._before).sum(axis=(1, 2))
        self._before = touching
