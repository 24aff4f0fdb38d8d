"""Start configurations: random ones by seed, and what a mission makes of given ones.

Scenario k of seed S draws from `SeedSequence(S, spawn_key=(k,))`, with one child for the robots and one for the items.
So a scenario does not depend on the number of scenarios or workers, nor do its items depend on the number of robots.
"""

import zlib

import numpy as np

from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.tasks import find_task
from clean_swarm_env.config.types import ConfigurationError
from selector.documents.errors import validated
from selforg.arrays import Floats
from selforg.space import Torus

START_GAP = 0.01
"""Clearance between solid robots at the start [m]."""
START_TRIES = 20_000
"""Draws for the place of one robot before the placement fails."""


def random_start(mission: MissionConfig, seed: int, index: int) -> StartConfiguration:
    """Return scenario `index` (from 0) of `seed`: uniform robots that do not overlap if solid, and items of the task.

    Its id is `index + 1`. Raises ConfigurationError if a robot finds no room in a bounded number of tries.
    """
    return drawn_start(mission, np.random.SeedSequence(seed, spawn_key=(index,)), str(index + 1))


def drawn_start(mission: MissionConfig, sequence: np.random.SeedSequence, name: str) -> StartConfiguration:
    """Return a start with the id `name`, drawn from two children of `sequence`; see `random_start`.

    Tasks other than cleaning place robots and things themselves.
    """
    kind = find_task(mission.task.name)
    if not kind.begins_as_given:
        return StartConfiguration(id=name, robots=())
    for_robots, for_items = sequence.spawn(2)
    size = np.array([mission.world.width, mission.world.height])
    apart = 2.0 * mission.robots.radius + START_GAP if mission.world.contacts == "solid" else 0.0
    rng = np.random.default_rng(for_robots)
    positions = _positions_apart(mission.robots.count, size, apart, rng)
    headings = rng.uniform(-np.pi, np.pi, size=(mission.robots.count, 1))
    items = kind.place_items(mission, np.random.default_rng(for_items))
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


def for_start(mission: MissionConfig, start: StartConfiguration) -> MissionConfig:
    """Return `mission` with the counts of `start`; a start that does not fit raises ConfigurationError."""
    kind = find_task(mission.task.name)
    if not start.robots and not kind.begins_as_given:
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
    task = kind.with_items(mission, count=len(start.items))
    parts = {"robots": {**mission.robots.model_dump(), "count": len(robots)}, "task": task.model_dump()}
    return validated(MissionConfig, {**mission.model_dump(), **parts}, f"scenario {start.id}", own=True)
