"""Observations of the robots: the chosen terms, computed for all rows at once."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import accumulate
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.observation.around import Around, open_around
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.searches import search
from clean_swarm_env.learning.observation.term import (
    AROUND_TERMS,
    TERMS,
    CompiledTerm,
    Observed,
    TermGroup,
    Writer,
)
from clean_swarm_env.learning.progress import MissionProgress, avoidance_column
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import KEPT, READ, SCRATCH, Floats, Ints
from selforg.compiler.decorators import long_kernel
from selforg.compiler.records import Handle, Packed
from selforg.declared import make_arrays
from selforg.mechanisms.steering.base import OTHER_COLUMNS

Observations = NDArray[np.float32]


class Observer:
    """Observations (R, F) of a batch of worlds.

    Attributes:
        names: (F,) names of the components.
        width: F.
        bounds: (F,) float32, largest amount of each component.

    """

    bounds: Annotated[Observations, "F", READ]
    _weights: Annotated[Observations, "F", READ]
    _rows: Annotated[Ints, "R", SCRATCH]
    _seen: Annotated[Floats, "R F", SCRATCH]
    _most: Annotated[Floats, "R M", KEPT]  # largest values so far of the M components that are remembered
    _all: Annotated[Ints, "W", READ]
    _remembered: Annotated[Ints, "M", READ]  # which components these are
    _first: Annotated[Ints, "TERMS", READ]  # first component of each of AROUND_TERMS, -1: not chosen

    def __init__(self, worlds: Worlds, progress: MissionProgress, config: ObservationConfig | None = None) -> None:
        self.config = (config or ObservationConfig()).of(worlds.task.terms)
        self._worlds = worlds
        self._around = Packed(around_robots(worlds, progress, self.config))
        self._held = [coordinator.held for coordinator in worlds.coordinators]
        observed = Observed(worlds, progress, self._around)
        terms = self.config.build(observed)
        names = [name for term in terms for name in term.components]
        sizes = [len(term.components) for term in terms]
        weights = np.repeat([np.float32(term.weight) for term in self.config.terms or ()], sizes)
        remembered = np.repeat([term.name in self.config.remembers for term in terms], sizes)
        self._remembered = np.flatnonzero(remembered)
        self.names = (*names, *(f"most_{names[k]}" for k in self._remembered))
        self.width, self._weights = len(self.names), np.append(weights, weights[self._remembered])
        self.bounds = np.abs(self._weights)
        make_arrays(self, R=worlds.rows, F=self.width, M=len(self._remembered))
        self._all = np.arange(worlds.worlds)
        places = [slice(last - size, last) for size, last in zip(sizes, accumulate(sizes), strict=True)]
        chosen = dict(zip((term.name for term in terms), places, strict=True))
        self._first = first_components(AROUND_TERMS, chosen)
        kinds = (TERMS.find(name) for name in (*worlds.task.terms, *chosen))
        groups = dict.fromkeys(kind.group for kind in kinds if issubclass(kind, CompiledTerm))
        self._groups: list[Writer] = [
            group.writer(observed, self.config, first_components(group, chosen)) for group in groups if group.writer
        ]
        self._own = [(term, own) for term, own in zip(terms, places, strict=True) if not isinstance(term, CompiledTerm)]

    def observe(self, observations: Observations, chosen: Ints | None = None) -> None:
        """Write what is now into `observations` (R, F), for all worlds or for the `chosen` (C,)."""
        worlds, around = self._all if chosen is None else chosen, self._around
        around.record.ticks[:] = self._worlds.ticks
        for number, held in enumerate(self._held):
            around.record.held[number] = held
        rows = self._rows[: search(around.handle, self._worlds.minds.poses.packed.handle, worlds, self._rows)]
        self._seen.fill(0.0)
        for group in self._groups:
            group.write(worlds, rows, self._seen)
        for term, components in self._own:
            term.write(rows, self._seen.T[components])
        write_observations(around.handle, worlds, self._first, self._seen, self._weights, observations)
        if len(self._remembered):
            self._remember(worlds, rows, observations)

    def _remember(self, worlds: Ints, rows: Ints, observations: Observations) -> None:
        """Write the largest values so far of `rows` (P,) of `worlds` (C,), which begin anew with the mission."""
        begins = np.zeros(self._worlds.worlds, dtype=np.bool_)
        begins[worlds] = self._worlds.ticks[worlds] == 0
        self._most[begins[self._worlds.world.of_row]] = 0.0
        self._most[rows] = np.maximum(self._most[rows], self._seen[np.ix_(rows, self._remembered)])
        first = self.width - len(self._remembered)
        observations[rows, first:] = self._most[rows].astype(np.float32) * self._weights[first:]


def around_robots(worlds: Worlds, progress: MissionProgress, config: ObservationConfig) -> Around:
    """Return the surroundings of the robots of `worlds`, before any search."""
    physics, network, robots = worlds.physics, worlds.network, worlds.mission.robots
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
        readings=network.readings,
        marks=network.state.marks,
        limits=worlds.world.limits,
        idle=progress.idle,
        first_options=np.cumsum([0, *sizes])[:-1],
        ranges=np.array(config.neighbour_ranges),
        longest=worlds.floor.ground.longest,
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
        neighbour=numbers(worlds.rows),
        heard=np.zeros((worlds.rows, OTHER_COLUMNS)),
        within=numbers(worlds.rows, len(config.neighbour_ranges)),
        others=np.zeros((worlds.robots, OTHER_COLUMNS)),
    )


def first_components(group: TermGroup[Any], chosen: Mapping[str, slice]) -> Ints:
    """Return the first component of each term of a group (TERMS,), -1 for one that is not among those `chosen`."""
    return np.array([chosen[name].start if name in chosen else -1 for name in group.names], dtype=np.int64)


write_terms = AROUND_TERMS.write_terms


@long_kernel
def write_observations(
    around: Handle[Around], chosen: Ints, first: Ints, seen: Floats, weights: Observations, observations: Observations
) -> None:
    """Write the terms that are chosen into `seen` (R, F), and that times `weights` (F,) into `observations` (R, F).

    The worlds are those `chosen` (C,). `first` holds the first component of each of AROUND_TERMS, -1 for one that is
    not chosen. Robots that are not at work see nothing.
    """
    a = open_around(around)
    for world in chosen:
        for row in range(world * a.robots, (world + 1) * a.robots):
            if a.working[row]:
                write_terms(a, first, row, seen[row])
            for k in range(weights.shape[0]):
                observations[row, k] = np.float32(seen[row, k]) * weights[k] if a.working[row] else np.float32(0.0)
