"""Start configurations: random ones by seed, those of a file, and what a mission makes of given ones.

Scenario k of seed S draws from `SeedSequence(S, spawn_key=(k,))`, with one child for the robots and one for the items.
So a scenario does not depend on the number of scenarios or workers, nor do its items depend on the number of robots.
"""

import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Final, Self

import numpy as np
from pydantic import Field, model_validator

from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.tasks import NO_ITEMS, TaskSettings, items_of, with_items
from clean_swarm_env.config.types import ConfigurationError, Point
from selector.documents.errors import check_unique, shown, validated
from selector.documents.fields import Closed, Positive
from selector.documents.reading import read_json
from selforg.arrays import Floats
from selforg.elementary import unit_vectors
from selforg.space import Torus

START_GAP = 0.01
"""Clearance between solid robots at the start [m]."""
START_TRIES = 20_000
"""Draws for the place of one robot before the placement fails."""
MOST_DRAWS: Final = 10_000
"""Draws for places among walls before they fail."""


def draw_places(count: int, rng: np.random.Generator, mission: MissionConfig, spots: Sequence[Point]) -> Floats:
    """Return random places (count, 2) [m] that robots can reach: about `spots` [m], or anywhere without any."""
    places = _anywhere(count, rng, mission, spots)
    if not mission.world.has_walls:
        return places
    for _ in range(MOST_DRAWS):
        blocked = np.flatnonzero([not mission.is_free(place) for place in places])
        if not len(blocked):
            return places
        places[blocked] = _anywhere(len(blocked), rng, mission, spots)
    raise ConfigurationError("task: expected room for items among the walls, found none")


def _anywhere(count: int, rng: np.random.Generator, mission: MissionConfig, spots: Sequence[Point]) -> Floats:
    """Return random places (count, 2) [m], also in walls: even on the ground, or on the discs around `spots`."""
    if not spots:
        return rng.uniform(size=(count, 2)) * mission.size
    spot, share, turn = rng.uniform(size=(count, 3)).T
    chosen = np.array(spots)[(spot * len(spots)).astype(np.int64)]
    ways = np.stack(unit_vectors(2.0 * np.pi * turn), axis=1)
    return Torus(*mission.extent).wrap(chosen + items_of(mission).spot_radius * np.sqrt(share)[:, None] * ways)


def random_start(mission: MissionConfig, seed: int, index: int) -> StartConfiguration:
    """Return scenario `index` (from 0) of `seed`: uniform robots that do not overlap if solid, and items of the task.

    Its id is `index + 1`. Raises ConfigurationError if a robot finds no room in a bounded number of tries.
    """
    return drawn_start(mission, np.random.SeedSequence(seed, spawn_key=(index,)), str(index + 1))


def drawn_start(mission: MissionConfig, sequence: np.random.SeedSequence, name: str) -> StartConfiguration:
    """Return a start with the id `name`, drawn from two children of `sequence`; see `random_start`.

    Tasks without items place robots and things themselves.
    """
    if items_of(mission) is NO_ITEMS:
        return StartConfiguration(id=name, robots=())
    for_robots, for_items = sequence.spawn(2)
    radii = mission.of_each("radius")[: mission.robots.count] if mission.world.contacts == "solid" else None
    rng = np.random.default_rng(for_robots)
    positions = _positions_apart(mission, radii, rng)
    headings = rng.uniform(-np.pi, np.pi, size=(mission.robots.count, 1))
    items = draw_places(items_of(mission).count, np.random.default_rng(for_items), mission, items_of(mission).spots)
    return StartConfiguration(
        id=name,
        robots=tuple((x, y, heading) for (x, y), (heading,) in zip(positions.tolist(), headings.tolist(), strict=True)),
        items=tuple((x, y) for x, y in items.tolist()),
    )


def _positions_apart(mission: MissionConfig, radii: Floats | None, rng: np.random.Generator) -> Floats:
    """Return (N, 2) uniform free positions [m] on the ground, with room for discs of `radii` (N,) [m]."""
    count, size, extent = mission.robots.count, mission.size, np.array(mission.extent)
    positions = np.empty((count, 2))
    for placed in range(count):
        for _ in range(START_TRIES):
            candidate = rng.uniform(size=2) * size
            room = radii is None or has_room(candidate, radii[placed], positions[:placed], radii[:placed], extent)
            if room and mission.is_free(candidate):
                positions[placed] = candidate
                break
        else:
            expected = f"room for {count} solid robots {START_GAP:g} m apart on {size[0]:g} m x {size[1]:g} m"
            raise ConfigurationError(f"robots.count: expected {expected}, got stuck after {placed} of them")
    return positions


def has_room(point: Floats, radius: float, others: Floats, radii: Floats, size: Floats) -> bool:
    """Return whether a disc of a radius [m] at `point` (2,) is START_GAP or more away from all others on the torus.

    Their middles are `others` (K, 2) and their radii (K,) [m].
    """
    return bool((distances(point, others, size) >= radius + radii + START_GAP).all())


def distances(point: Floats, others: Floats, size: Floats) -> Floats:
    """Return the distances (K,) [m] of `point` (2,) to `others` (K, 2) on the torus."""
    offsets = Torus(float(size[0]), float(size[1])).offsets(point, others)
    return np.asarray(np.sqrt((offsets * offsets).sum(axis=1)))


def run_seed(seed: int, scenario: str) -> int:
    """Return the seed of a mission from the experiment's seed and the scenario's id, equal for all conditions."""
    key = zlib.crc32(scenario.encode())
    return int(np.random.SeedSequence(seed, spawn_key=(key, 0)).generate_state(1, np.uint32)[0])


def for_start(mission: MissionConfig, start: StartConfiguration) -> MissionConfig:
    """Return `mission` with the counts of `start`; a start that does not fit raises ConfigurationError."""
    if not start.robots and items_of(mission) is NO_ITEMS:
        return mission
    size = np.array(mission.extent)
    robots = np.array(start.robots).reshape(-1, 3)
    for what, points in (("robots", robots[:, :2]), ("items", np.array(start.items).reshape(-1, 2))):
        for row, point in enumerate(points):
            if not ((point >= 0.0) & (point <= size)).all():
                expected = f"a point on the torus {size[0]:g} m x {size[1]:g} m"
            elif not mission.is_free(point):
                expected = "a place that robots can reach among the walls"
            else:
                continue
            raise ConfigurationError(f"scenario {start.id}: {what}.{row}: expected {expected}, got {point.tolist()}")
    if mission.robots.groups and len(robots) != mission.robots.count:
        expected = f"{mission.robots.count}, as in the groups of the mission"
        raise ConfigurationError(f"scenario {start.id}: robots: expected {expected}, got {len(robots)}")
    task = with_items(mission.task, count=len(start.items))
    count = {} if mission.robots.groups else {"count": len(robots)}
    parts = {"robots": {**mission.robots.model_dump(), **count}, "task": task.model_dump()}
    found = validated(MissionConfig, {**mission.model_dump(), **parts}, f"scenario {start.id}", own=True)
    if mission.world.contacts == "solid":
        _check_apart(found, start.id, robots[:, :2], size)
    return found


def _check_apart(mission: MissionConfig, scenario: str, places: Floats, size: Floats) -> None:
    """Raise ConfigurationError for the first of the solid robots at places (N, 2) [m] that lies in another."""
    radii = mission.of_each("radius")
    for row in range(1, len(places)):
        away = distances(places[row], places[:row], size)
        if (away < radii[row] + radii[:row]).any():
            nearest = int((away - radii[:row]).argmin())
            expected = f"solid robots at least {radii[row] + radii[nearest]:g} m apart"
            raise ConfigurationError(
                f"scenario {scenario}: robots.{row}: expected {expected}, got {away[nearest]:.3g} m"
            )


class StartsCase(StartConfiguration, extra="ignore"):
    """One case of a file of start configurations."""

    measured: dict[str, dict[str, float | None]] = Field(default={})
    """Name of a condition -> figure -> value, as measured on this case by another implementation."""


class StartsFile(Closed, extra="ignore"):
    """A file of start configurations with its torus; keys that no task reads are ignored, for the files of others."""

    torus_m: tuple[Positive, Positive]
    """Lengths of the torus along x and y [m]."""
    cases: Annotated[tuple[StartsCase, ...], Field(min_length=1)]
    """The start configurations, each with the figures measured on it."""

    @model_validator(mode="after")
    def _unique_ids(self) -> Self:
        check_unique("cases", [case.id for case in self.cases], "ids")
        return self

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a JSON file; one that cannot be used raises ConfigurationError."""
        return validated(cls, read_json(path), shown(path))

    @property
    def starts(self) -> tuple[StartConfiguration, ...]:
        """The start configurations alone."""
        return tuple(StartConfiguration(id=c.id, robots=c.robots, items=c.items) for c in self.cases)

    @property
    def measured(self) -> Mapping[str, Mapping[str, Mapping[str, float | None]]]:
        """Scenario -> name of a condition -> figure -> value."""
        return {case.id: case.measured for case in self.cases}

    def task_of(self, mission: MissionConfig) -> TaskSettings:
        """Return the settings of the task of a mission with what this file says of it."""
        return mission.task

    def world_of(self, mission: MissionConfig) -> MissionConfig:
        """Return `mission` on the torus of this file, with what it says of the task."""
        width, height = self.torus_m
        world = mission.world.model_copy(update={"width": width, "height": height})
        parts = {"world": world.model_dump(), "task": self.task_of(mission).model_dump()}
        return validated(
            MissionConfig, {**mission.model_dump(), **parts}, "the mission on the torus of this file", own=True
        )
