"""A term about stations: whether all of a kind stand in one yard."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from clean_swarm_env.tasks.cleaning.task import cleaning_of
from selforg.arrays import Floats, Ints
from selforg.space import Torus


@TERMS.register
class YardsTerm(Term):
    """One flag: all stations of the kind that the robot needs next are within `together` [m] of each other, or not."""

    name = "yards"
    components = ("one_yard", "several_yards")

    def __init__(self, observed: Observed, *, together: float = 2.0) -> None:
        super().__init__(observed)
        self.together = together

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags."""
        worlds = self.observed.worlds
        task = cleaning_of(worlds.task)
        space, kinds = Torus(*worlds.extent.tolist()), task.site.kinds
        apart = np.zeros((worlds.worlds, 2), dtype=np.bool_)
        for kind in range(2):
            places = task.stations[:, kinds == kind]  # (W, K, 2)
            offsets = space.offsets(np.broadcast_to(places[:, :1], places.shape), places)
            apart[:, kind] = ((offsets**2).sum(axis=2) > self.together**2).any(axis=1)
        several = apart[rows // worlds.robots, task.garbage.recycled[rows]]
        out[0, rows], out[1, rows] = ~several, several
