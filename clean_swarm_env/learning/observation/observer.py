"""Observations of the robots: the chosen terms, computed for all rows at once."""

from __future__ import annotations

from collections.abc import Callable
from itertools import accumulate
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.observation.around import AROUND_RECORD, Around, open_around
from clean_swarm_env.learning.observation.config import DEFAULT_TERMS, ObservationConfig
from clean_swarm_env.learning.observation.searches import search
from clean_swarm_env.learning.observation.term import TERMS, CompiledTerm, Observed, Term
from clean_swarm_env.learning.progress import MissionProgress, avoidance_column
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import READ, SCRATCH, Floats, Ints
from selforg.compiler.decorators import inlined, long_kernel
from selforg.compiler.records import Words
from selforg.mechanisms.steering.base import OTHER_COLUMNS

Observations = NDArray[np.float32]


class Observer:
    """Observations (R, F) of a batch of worlds.

    Attributes:
        names: (F,) names of the components.
        width: F.
        bounds: (F,) float32, largest amount of each component.
        phases: (R,) int64, number of the phase each robot was in when it was last observed (`PHASES`).

    """

    bounds: Annotated[Observations, "F", READ]
    _weights: Annotated[Observations, "F", READ]
    _rows: Annotated[Ints, "R", SCRATCH]
    _seen: Annotated[Floats, "R F", SCRATCH]
    _all: Annotated[Ints, "W", READ]
    _first: Annotated[Ints, "TERMS", READ]  # first component of each compiled term, -1: not chosen

    def __init__(self, worlds: Worlds, progress: MissionProgress, config: ObservationConfig | None = None) -> None:
        self.config = config or ObservationConfig()
        self._worlds = worlds
        self._around = AROUND_RECORD.pack(around_robots(worlds, progress, self.config))
        self._held = [coordinator.held for coordinator in worlds.coordinators]
        terms = self.config.build(Observed(worlds, progress, self._around))
        self.names = tuple(name for term in terms for name in term.components)
        self.width = len(self.names)
        sizes = [len(term.components) for term in terms]
        self._weights = np.repeat([np.float32(term.weight) for term in self.config.terms], sizes)
        self.bounds = np.abs(self._weights)
        self.phases = self._around.record.phases
        self._rows = np.zeros(worlds.rows, dtype=np.int64)
        self._seen = np.zeros((worlds.rows, self.width))
        self._all = np.arange(worlds.worlds)
        self._first = np.full(len(DEFAULT_TERMS), -1)  # first component of each compiled term, -1: not chosen
        self._own: list[tuple[Term, slice]] = []  # terms of the user's own, and their components
        for term, first, last in zip(terms, accumulate(sizes, initial=0), accumulate(sizes), strict=False):
            if isinstance(term, CompiledTerm):
                self._first[DEFAULT_TERMS.index(term.name)] = first
            else:
                self._own.append((term, slice(first, last)))

    def observe(self, observations: Observations, chosen: Ints | None = None) -> None:
        """Write what is now into `observations` (R, F), for all worlds or for the `chosen` (C,)."""
        worlds, around = self._all if chosen is None else chosen, self._around
        around.record.ticks[:] = self._worlds.ticks
        for number, held in enumerate(self._held):
            around.record.held[number] = held
        rows = self._rows[: search(around.words, self._worlds.minds.poses.packed.words, worlds, self._rows)]
        self._seen.fill(0.0)
        for term, components in self._own:
            term.write(rows, self._seen.T[components])
        write_observations(around.words, worlds, self._first, self._seen, self._weights, observations)


def around_robots(worlds: Worlds, progress: MissionProgress, config: ObservationConfig) -> Around:
    """Return the surroundings of the robots of `worlds`, before any search."""
    physics, items, network, robots = worlds.physics, worlds.task.item_arrays(), worlds.network, worlds.mission.robots
    sizes = [len(coordinator.model.options) for coordinator in worlds.coordinators]

    def numbers(*shape: int) -> Ints:
        return np.zeros(shape, dtype=np.int64)

    return Around(
        robots=worlds.robots,
        extent=worlds.extent,
        positions=physics.positions,
        headings=physics.headings,
        present=physics.present,
        working=worlds.team.working,
        speed=worlds.floor.drive.speed,
        turn_rate=worlds.floor.drive.turn_rate,
        cargo=items.cargo,
        recycled=items.recycled,
        items=items.positions,
        stage=items.stage,
        stations=items.stations,
        station_kinds=items.station_kinds,
        readings=network.readings,
        marks=network.state.marks,
        limits=worlds.world.limits,
        idle=progress.idle,
        first_options=np.cumsum([0, *sizes])[:-1],
        ranges=np.array(config.neighbour_ranges),
        sight=items.sight,
        longest=worlds.floor.ground.longest,
        station_range=config.station_range,
        full_crowd=config.full_crowd,
        patience=max(config.patience / worlds.period, 1.0),
        reach=max(robots.pose_diffusion + robots.pose_goal_radius, 1e-9),
        max_speed=worlds.floor.drive.max_speed,
        max_turn_rate=worlds.world.of_each("max_turn_rate"),
        fastest=robots.max_speed,
        avoidance=network.model.sensor_index.get("rep_len", -1),
        avoiding=avoidance_column(worlds),
        ticks=numbers(worlds.worlds),
        held=numbers(len(sizes), worlds.rows),
        item=numbers(worlds.rows),
        phases=numbers(worlds.rows),
        station_distances=np.zeros((worlds.rows, 2)),
        station_ways=np.zeros((worlds.rows, 2, 3)),
        neighbour=numbers(worlds.rows),
        heard=np.zeros((worlds.rows, OTHER_COLUMNS)),
        within=numbers(worlds.rows, len(config.neighbour_ranges)),
    )


WriteTerms = Callable[[Around, Ints, int, Floats], None]


@inlined
def write_nothing(around: Around, first: Ints, row: int, seen: Floats) -> None:
    """Write no component."""


def write_also(before: WriteTerms, name: str) -> WriteTerms:
    """Return a function that writes the terms that `before` writes, and the compiled term of this name."""
    number, term = DEFAULT_TERMS.index(name), TERMS.find(name)
    assert issubclass(term, CompiledTerm)
    write_row = term.write_row

    @inlined
    def write_both(around: Around, first: Ints, row: int, seen: Floats) -> None:
        before(around, first, row, seen)
        if first[number] >= 0:
            write_row(around, row, seen[first[number] :])

    return write_both


write_terms: WriteTerms = write_nothing
for _name in DEFAULT_TERMS:
    write_terms = write_also(write_terms, _name)


@long_kernel
def write_observations(
    around: Words[Around], chosen: Ints, first: Ints, seen: Floats, weights: Observations, observations: Observations
) -> None:
    """Write the terms that are chosen into `seen` (R, F), and that times `weights` (F,) into `observations` (R, F).

    The worlds are those `chosen` (C,). `first` holds the first component of each of DEFAULT_TERMS, -1 for one that is
    not chosen. Robots that are not at work see nothing.
    """
    a = open_around(around)
    for world in chosen:
        for row in range(world * a.robots, (world + 1) * a.robots):
            if a.working[row]:
                write_terms(a, first, row, seen[row])
            for k in range(weights.shape[0]):
                observations[row, k] = np.float32(seen[row, k]) * weights[k] if a.working[row] else np.float32(0.0)
