"""A term about finds: where robots picked garbage lately."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from selforg.arrays import Floats, Ints
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c

FINDS = Filter(("find",), moving=False, view_distance=np.inf)
"""The pheromones that robots of the document `cleaning-patrol` leave where they pick."""


@TERMS.register
class FindsTerm(Term):
    """One flag: no find is felt; they are apart; or half of them or more lie within `together` [m] of the latest."""

    name = "finds"
    components = ("finds_none", "finds_apart", "finds_together")

    def __init__(self, observed: Observed, *, together: float = 2.0) -> None:
        super().__init__(observed)
        self.together = together
        self._queries = Queries(observed.worlds.minds.buffers["pheromones"])

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags."""
        worlds = self.observed.worlds
        seen = self._queries.gather(worlds.now, rows, FINDS)
        count = np.diff(seen.start)
        robot = np.repeat(np.arange(len(rows)), count)
        felt = count > 0
        latest = np.zeros(len(rows), dtype=np.int64)
        latest[felt] = np.lexsort((seen.pairs[:, c.PAIR_DIFFUSION], robot))[seen.start[1:][felt] - 1]
        ways = seen.pairs[:, [c.PAIR_DX, c.PAIR_DY]]
        apart = ways - ways[latest[robot]]
        apart -= worlds.extent * np.rint(apart / worlds.extent)
        near = np.bincount(robot[(apart**2).sum(axis=1) <= self.together**2], minlength=len(rows))
        together = felt & (2 * (near - 1) >= count - 1)
        out[0, rows], out[1, rows], out[2, rows] = ~felt, felt & ~together, together
