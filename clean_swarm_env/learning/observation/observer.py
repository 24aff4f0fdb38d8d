"""What a selector sees of each robot: the chosen terms, computed for all rows at once."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.observation.around import AROUND_RECORD, Around, open_around
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.searches import find_items, find_neighbours, find_stations, list_present
from clean_swarm_env.learning.observation.term import Observed
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Words

Observations = NDArray[np.float32]
SEARCHES = {"stations": find_stations, "neighbours": find_neighbours}
"""What terms may need -> how it is found."""


class Observer:
    """Observations (R, F) of a batch of worlds.

    Attributes:
        names: (F,) of the components.
        width: F.
        bounds: (F,) float32, largest amount of each component.
        phases: (R,) int64, number of the phase each robot was in when it was last observed (`PHASES`).

    """

    def __init__(self, worlds: Worlds, progress: MissionProgress, config: ObservationConfig | None = None) -> None:
        self.config = config or ObservationConfig()
        self._around = AROUND_RECORD.pack(around_robots(worlds, self.config.neighbour_ranges))
        self._terms = self.config.build(Observed(worlds, progress, self._around))
        needed = {need for term in self._terms for need in term.needs}
        self._searches = [search for name, search in SEARCHES.items() if name in needed]
        self.names = tuple(name for term in self._terms for name in term.components)
        self.width = len(self.names)
        sizes = [len(term.components) for term in self._terms]
        self._lines = [slice(end - size, end) for size, end in zip(sizes, accumulate(sizes), strict=True)]
        self._weights: Observations = np.repeat([np.float32(term.weight) for term in self.config.terms], sizes)
        self.bounds: Observations = np.abs(self._weights)
        self.phases = self._around.record.phases
        self._rows: Ints = np.zeros(worlds.rows, dtype=np.int64)
        self._seen: Floats = np.zeros((self.width, worlds.rows))
        self._all = np.arange(worlds.worlds)

    def observe(self, observations: Observations, chosen: Ints | None = None) -> None:
        """Fill `observations` (R, F) with what is so now, of all worlds or of the `chosen` (C,)."""
        worlds, words = self._all if chosen is None else chosen, self._around.words
        rows = self._rows[: list_present(words, worlds, self._rows)]
        find_items(words, rows)
        for search in self._searches:
            search(words, rows)
        self._seen.fill(0.0)
        for term, lines in zip(self._terms, self._lines, strict=True):
            term.write(rows, self._seen[lines])
        weigh(words, worlds, self._seen, self._weights, observations)


def around_robots(worlds: Worlds, neighbour_ranges: tuple[float, ...]) -> Around:
    """Return what is around the robots of `worlds`, with nothing found yet."""
    garbage, physics = worlds.garbage, worlds.physics

    def numbers(*shape: int) -> Ints:
        return np.zeros(shape, dtype=np.int64)

    return Around(
        extent=worlds.extent,
        positions=physics.positions,
        headings=physics.headings,
        present=physics.present,
        cargo=garbage.cargo,
        recycled=garbage.recycled,
        items=garbage.positions,
        stage=garbage.stage,
        stations=worlds.stations,
        sight=worlds.floor.packed.record.sight,
        longest=0.5 * float(np.hypot(*worlds.extent)),
        ranges=np.array(neighbour_ranges),
        team=numbers(worlds.worlds),
        item=numbers(worlds.rows),
        phases=numbers(worlds.rows),
        station_distances=np.zeros((2, worlds.rows)),
        station_ways=np.zeros((2, 3, worlds.rows)),
        neighbour=numbers(worlds.rows),
        within=numbers(len(neighbour_ranges), worlds.rows),
        carriers=numbers(1, worlds.rows),
    )


@lean_kernel
def weigh(around: Words[Around], chosen: Ints, seen: Floats, weights: Observations, observations: Observations) -> None:
    """Write `seen` (F, R) times `weights` (F,) into `observations` (R, F), for the worlds `chosen` (C,).

    Robots that are not present see nothing.
    """
    a = open_around(around)
    robots = a.present.shape[0] // a.team.shape[0]
    for world in chosen:
        for row in range(world * robots, (world + 1) * robots):
            for k in range(weights.shape[0]):
                observations[row, k] = np.float32(seen[k, row]) * weights[k] if a.present[row] else np.float32(0.0)
