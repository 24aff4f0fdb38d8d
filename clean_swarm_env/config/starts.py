"""Start configurations: random ones by seed, and files of given ones with the figures measured on them.

Scenario k of seed S draws from `SeedSequence(S, spawn_key=(k,))`, with one child for the robots and one for the items.
So a scenario does not depend on the number of scenarios or workers, nor do its items depend on the number of robots.
"""

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.tasks import find_task
from clean_swarm_env.config.types import ConfigurationError, Point
from selector.documents.errors import impossible, shown, validated
from selector.documents.fields import Closed, Positive
from selector.documents.reading import read_json
from selforg.arrays import Floats
from selforg.elementary import unit_vectors
from selforg.space import Torus

START_GAP = 0.01
"""Clearance between solid robots at the start [m]."""
START_TRIES = 20_000
"""Draws for the place of one robot before the placement fails."""


@dataclass(frozen=True)
class Places:
    """Where items come: anywhere on the torus `size` (2,), or evenly within `radius` of a spot (S, 2) [m]."""

    size: Floats
    spots: Floats
    radius: float

    @classmethod
    def of(cls, mission: MissionConfig) -> "Places":
        """Return where the items of a mission come at first."""
        size = np.array([mission.world.width, mission.world.height])
        return cls(size, np.array(mission.garbage.spots).reshape(-1, 2), mission.garbage.spot_radius)

    def at(self, spots: Sequence[Point]) -> "Places":
        """Return the same with other spots."""
        return replace(self, spots=np.array(spots).reshape(-1, 2))

    def draw(self, count: int, rng: np.random.Generator) -> Floats:
        """Return random places (count, 2) [m]."""
        if not len(self.spots):
            return rng.uniform(size=(count, 2)) * self.size
        spot, share, turn = rng.uniform(size=(count, 3)).T
        chosen = self.spots[(spot * len(self.spots)).astype(np.int64)]
        ways = np.stack(unit_vectors(2.0 * np.pi * turn), axis=1)
        return Torus(*self.size.tolist()).wrap(chosen + self.radius * np.sqrt(share)[:, None] * ways)


def random_start(mission: MissionConfig, seed: int, index: int) -> StartConfiguration:
    """Return scenario `index` (from 0) of `seed`: uniform robots that do not overlap if solid, items at `Places`.

    Its id is `index + 1`. Raises ConfigurationError if a robot finds no room in a bounded number of tries.
    """
    return drawn_start(mission, np.random.SeedSequence(seed, spawn_key=(index,)), str(index + 1))


def drawn_start(mission: MissionConfig, sequence: np.random.SeedSequence, name: str) -> StartConfiguration:
    """Return a start with the id `name`, drawn from two children of `sequence`; see `random_start`.

    Tasks other than cleaning place robots and things themselves.
    """
    if not find_task(mission.task.name).begins_as_given:
        return StartConfiguration(id=name, robots=())
    for_robots, for_items = sequence.spawn(2)
    size = np.array([mission.world.width, mission.world.height])
    apart = 2.0 * mission.robots.radius + START_GAP if mission.world.contacts == "solid" else 0.0
    rng = np.random.default_rng(for_robots)
    positions = _positions_apart(mission.robots.count, size, apart, rng)
    headings = rng.uniform(-np.pi, np.pi, size=(mission.robots.count, 1))
    items = Places.of(mission).draw(mission.garbage.count, np.random.default_rng(for_items))
    return StartConfiguration(
        id=name,
        robots=tuple((x, y, heading) for (x, y), (heading,) in zip(positions.tolist(), headings.tolist(), strict=True)),
        items=tuple((x, y) for x, y in items.tolist()),
    )


def _positions_apart(count: int, size: Floats, apart: float, rng: np.random.Generator) -> Floats:
    """Return (N, 2) uniform positions [m] on the torus `size` (2,) whose distances are at least `apart` [m]."""
    positions = np.empty((count, 2))
    for placed in range(count):
        for _ in range(START_TRIES):
            candidate = rng.uniform(size=2) * size
            if nearest_distance(candidate, positions[:placed], size) >= apart:
                positions[placed] = candidate
                break
        else:
            expected = f"room for {count} robots {apart:g} m apart on {size[0]:g} m x {size[1]:g} m"
            raise ConfigurationError(f"robots.count: expected {expected}, got stuck after {placed} of them")
    return positions


def nearest_distance(point: Floats, others: Floats, size: Floats) -> float:
    """Return the distance [m] of `point` (2,) to the nearest of `others` (N, 2) on the torus; infinite without any."""
    offsets = Torus(float(size[0]), float(size[1])).offsets(point, others)
    return float(np.sqrt((offsets * offsets).sum(axis=1)).min(initial=np.inf))


def run_seed(seed: int, scenario: str) -> int:
    """Return the seed of a mission from the experiment's seed and the scenario's id, equal for all conditions."""
    key = zlib.crc32(scenario.encode())
    return int(np.random.SeedSequence(seed, spawn_key=(key, 0)).generate_state(1, np.uint32)[0])


class StartsCase(StartConfiguration, extra="ignore"):
    """One case of a file of start configurations."""

    measured: dict[str, dict[str, float | None]] = Field(default={})
    """Name of a condition -> figure -> value, as measured on this case by another implementation."""


class StartsFile(Closed, extra="ignore"):
    """A file of start configurations with its torus and stations; further keys are ignored, for the files of others."""

    torus_m: tuple[Positive, Positive]
    """Lengths of the torus along x and y [m]."""
    recycling: Point
    """Position of the recycling station [m]."""
    dump: Point
    """Position of the dump station [m]."""
    cases: Annotated[tuple[StartsCase, ...], Field(min_length=1)]
    """The start configurations, each with the figures measured on it."""

    @model_validator(mode="after")
    def _unique_ids(self) -> Self:
        ids = [case.id for case in self.cases]
        for twice in (one for one in ids if ids.count(one) > 1):
            raise impossible("cases", "unique ids", f"{twice!r} twice")
        return self

    @property
    def starts(self) -> tuple[StartConfiguration, ...]:
        """The start configurations alone."""
        return tuple(StartConfiguration(id=c.id, robots=c.robots, items=c.items) for c in self.cases)

    @property
    def measured(self) -> Mapping[str, Mapping[str, Mapping[str, float | None]]]:
        """Scenario -> name of a condition -> figure -> value."""
        return {case.id: case.measured for case in self.cases}

    def world_of(self, mission: MissionConfig) -> MissionConfig:
        """Return `mission` on the torus and with the stations of this file."""
        width, height = self.torus_m
        world = mission.world.model_copy(update={"width": width, "height": height})
        stations = mission.stations.model_copy(update={"recycling": self.recycling, "dump": self.dump})
        parts = {"world": world.model_dump(), "stations": stations.model_dump()}
        return validated(
            MissionConfig, {**mission.model_dump(), **parts}, "the mission on the torus of this file", own=True
        )


def load_starts(path: Path) -> StartsFile:
    """Read a JSON file of start configurations; a file that cannot be used raises ConfigurationError."""
    return validated(StartsFile, read_json(path), shown(path))


def for_start(mission: MissionConfig, start: StartConfiguration) -> MissionConfig:
    """Return `mission` with the counts of `start`; a start that does not fit raises ConfigurationError."""
    if not start.robots and not find_task(mission.task.name).begins_as_given:
        return mission
    size = np.array(mission.extent)
    robots = np.array(start.robots).reshape(-1, 3)
    for what, points in (("robots", robots[:, :2]), ("items", np.array(start.items).reshape(-1, 2))):
        for row in np.flatnonzero(~np.all((points >= 0.0) & (points <= size), axis=1))[:1]:
            expected = f"a point on the torus {size[0]:g} m x {size[1]:g} m"
            raise ConfigurationError(
                f"scenario {start.id}: {what}.{row}: expected {expected}, got {points[row].tolist()}"
            )
    if mission.world.contacts == "solid":
        for row in range(1, len(robots)):
            distance = nearest_distance(robots[row, :2], robots[:row, :2], size)
            if distance < 2.0 * mission.robots.radius:
                expected = f"solid robots at least {2.0 * mission.robots.radius:g} m apart"
                raise ConfigurationError(
                    f"scenario {start.id}: robots.{row}: expected {expected}, got {distance:.3g} m"
                )
    counts = {"robots": {"count": len(robots)}, "garbage": {"count": len(start.items)}}
    parts = {name: {**getattr(mission, name).model_dump(), **change} for name, change in counts.items()}
    return validated(MissionConfig, {**mission.model_dump(), **parts}, f"scenario {start.id}", own=True)
