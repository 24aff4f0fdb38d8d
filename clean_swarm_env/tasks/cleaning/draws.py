"""Random places of garbage and stations, and random events, of scenarios of cleaning."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from clean_swarm_env.config.families import ChangesConfig
from clean_swarm_env.config.free_places import free_ground
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import MOST_DRAWS, distances
from clean_swarm_env.config.types import ConfigurationError, Point
from clean_swarm_env.config.world import WorldConfig
from clean_swarm_env.tasks.cleaning.settings import settings_of
from selforg.arrays import Floats

QUIET = 0.1
"""Share of the mission at its beginning and its end in which nothing changes [-]."""
STATION_GAP = 2.0
"""Least distance of the stations from each other [m]."""


@dataclass(frozen=True)
class Room:
    """The ground on which a family draws places for robots of `radius` [m], at least `apart` [m] from walls."""

    world: WorldConfig
    radius: float
    apart: float

    @classmethod
    def of(cls, mission: MissionConfig, size: Point) -> "Room":
        """Return the ground of a mission of cleaning if it has a `size` [m]."""
        world = mission.world.model_copy(update={"width": size[0], "height": size[1]})
        return cls(world, mission.robots.radius, settings_of(mission).stations.reach)

    @property
    def size(self) -> Floats:
        """Width and height (2,) [m]."""
        return np.array([self.world.width, self.world.height])

    def draw(self, rng: np.random.Generator) -> Floats:
        """Return a random place (2,) [m]."""
        for _ in range(MOST_DRAWS):
            place = rng.uniform(size=2) * self.size
            if not self.world.has_walls:
                return place
            free = free_ground(self.world, self.radius)
            if free.clearance(place) >= self.apart and free.has(place[None])[0]:
                return place
        raise ConfigurationError("mission.world.walls: expected room for stations and spots, found none")


def draw_events(
    changes: ChangesConfig,
    room: Room,
    robots: int,
    spots: int,
    time_limit: float,
    rng: np.random.Generator,
) -> list[dict[str, Any]]:
    """Return the events of one scenario that begins with `robots` and `spots`, in the order of their times.

    Spots that move remain as many, unless they come and go in phases. An event that would leave fewer than two robots
    becomes a join if robots may join; otherwise it is left out.
    """
    if changes.phases:
        return draw_phases(changes.phases, room, spots, time_limit, rng)
    number = int(rng.integers(changes.number[0], changes.number[1] + 1))
    times = np.sort(rng.uniform(QUIET, 1.0 - QUIET, size=number)) * time_limit
    working, numbered = list(range(robots)), robots
    events: list[dict[str, Any]] = []
    for time in times.tolist():
        kind = changes.kinds[int(rng.integers(len(changes.kinds)))]
        if kind in ("remove", "fail") and len(working) < 3:
            if "join" not in changes.kinds:
                continue
            kind = "join"
        event: dict[str, Any] = {"at": round(time, 3), "do": kind}
        if kind == "join":
            working.append(numbered)
            numbered += 1
        elif kind in ("remove", "fail"):
            event["robots"] = (working.pop(int(rng.integers(len(working)))),)
        elif kind == "move_spots":
            event["spots"] = random_spots(spots, room, rng)
        else:
            event |= _drawn(kind, changes, room, rng)
        events.append(event)
    return events


def draw_phases(
    phases: int, room: Room, spots: int, time_limit: float, rng: np.random.Generator
) -> list[dict[str, Any]]:
    """Return the events by which garbage comes at one new spot and anywhere in turn, if it first comes at `spots`."""
    at_spot = [(spots > 0) == (phase % 2 == 0) for phase in range(phases)]
    return [
        {"at": round(time_limit * k / phases, 3), "do": "move_spots", "spots": random_spots(int(at_spot[k]), room, rng)}
        for k in range(1, phases)
    ]


def _drawn(kind: str, changes: ChangesConfig, room: Room, rng: np.random.Generator) -> dict[str, Any]:
    """Return the fields of an event that does not change the team."""
    if kind == "land":
        return {"items": int(rng.integers(changes.items[0], changes.items[1] + 1))}
    if kind == "respawn":
        return {"rate": float(rng.uniform(*changes.respawn))}
    if kind == "move_stations":
        recycling, dump = random_stations(2, room, rng)
        return {"recycling": recycling, "dump": dump}
    return {"reach": float(rng.uniform(*changes.reach)), "loss": float(rng.uniform(*changes.loss))}


def random_spots(number: int, room: Room, rng: np.random.Generator) -> tuple[Point, ...]:
    """Return the centres of spots anywhere in the `room` [m]."""
    return tuple((float(x), float(y)) for x, y in (room.draw(rng) for _ in range(number)))


def random_stations(number: int, room: Room, rng: np.random.Generator) -> tuple[Point, ...]:
    """Return places of stations in the `room` [m], STATION_GAP or more apart where there is room."""
    extent = room.size
    gap = min(STATION_GAP, 0.3 * extent.min(), 0.5 * extent.min() / np.sqrt(number))
    places: list[Point] = []
    for _ in range(MOST_DRAWS):
        if len(places) == number:
            return tuple(places)
        place = room.draw(rng)
        if (distances(place, np.array(places).reshape(-1, 2), extent) >= gap).all():
            places.append((float(place[0]), float(place[1])))
    raise ConfigurationError(f"stations: expected room for {number} stations {gap:g} m apart, found none")
