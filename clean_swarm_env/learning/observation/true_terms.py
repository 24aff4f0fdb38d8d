"""The term of a truth that no robot can know, for machines that are told; it is in no default.

Why: docs/decisions/0214-what-robots-have-heard.md.
"""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.term import TERMS, Term
from clean_swarm_env.tasks.cleaning.task import cleaning_of
from selforg.arrays import Floats, Ints


@TERMS.register
class TrueSeasonTerm(Term):
    """One flag: garbage comes anywhere now, or about spots."""

    name = "true_season"
    components = ("true_anywhere", "true_spots")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags."""
        worlds = self.observed.worlds
        at_spots = np.repeat(cleaning_of(worlds.task).comings.at_spots, worlds.robots)[rows]
        out[0, rows], out[1, rows] = ~at_spots, at_spots
