"""Random places of garbage and stations, and random events, of scenarios of cleaning."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clean_swarm_env.config.families import ChangesConfig
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import nearest_distance
from clean_swarm_env.config.types import Point
from clean_swarm_env.tasks.cleaning.settings import settings_of
from selforg.arrays import Floats
from selforg.elementary import unit_vectors
from selforg.space import Torus

QUIET = 0.1
"""Share of the mission at its beginning and its end in which nothing changes [-]."""
STATION_GAP = 2.0
"""Least distance of the stations from each other [m]."""


@dataclass(frozen=True)
class Places:
    """Where items come: anywhere on the torus `size` (2,), or evenly within `radius` of a spot (S, 2) [m]."""

    size: Floats
    spots: Floats
    radius: float

    @classmethod
    def of(cls, mission: MissionConfig) -> "Places":
        """Return where the items of a mission come at first."""
        size, garbage = np.array([mission.world.width, mission.world.height]), settings_of(mission).garbage
        return cls(size, np.array(garbage.spots).reshape(-1, 2), garbage.spot_radius)

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


def draw_events(
    changes: ChangesConfig,
    size: tuple[float, float],
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
        return draw_phases(changes.phases, size, spots, time_limit, rng)
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
            event["spots"] = random_spots(spots, size, rng)
        else:
            event |= _drawn(kind, changes, size, rng)
        events.append(event)
    return events


def draw_phases(
    phases: int, size: tuple[float, float], spots: int, time_limit: float, rng: np.random.Generator
) -> list[dict[str, Any]]:
    """Return the events by which garbage comes at one new spot and anywhere in turn, if it first comes at `spots`."""
    at_spot = [(spots > 0) == (phase % 2 == 0) for phase in range(phases)]
    return [
        {"at": round(time_limit * k / phases, 3), "do": "move_spots", "spots": random_spots(int(at_spot[k]), size, rng)}
        for k in range(1, phases)
    ]


def _drawn(kind: str, changes: ChangesConfig, size: tuple[float, float], rng: np.random.Generator) -> dict[str, Any]:
    """Return the fields of an event that does not change the team."""
    if kind == "land":
        return {"items": int(rng.integers(changes.items[0], changes.items[1] + 1))}
    if kind == "respawn":
        return {"rate": float(rng.uniform(*changes.respawn))}
    if kind == "move_stations":
        recycling, dump = random_stations(2, size, rng)
        return {"recycling": recycling, "dump": dump}
    return {"reach": float(rng.uniform(*changes.reach)), "loss": float(rng.uniform(*changes.loss))}


def random_spots(number: int, size: tuple[float, float], rng: np.random.Generator) -> tuple[Point, ...]:
    """Return the centres of spots anywhere on the torus `size` [m]."""
    return tuple((x, y) for x, y in (rng.uniform(size=(number, 2)) * size).tolist())


def random_stations(number: int, size: tuple[float, float], rng: np.random.Generator) -> tuple[Point, ...]:
    """Return places of stations on the torus `size` [m], STATION_GAP or more apart where there is room."""
    gap = min(STATION_GAP, 0.3 * min(size), 0.5 * min(size) / np.sqrt(number))
    extent = np.array(size)
    places: list[Point] = []
    while len(places) < number:
        place = rng.uniform(size=2) * extent
        if nearest_distance(place, np.array(places).reshape(-1, 2), extent) >= gap:
            places.append((float(place[0]), float(place[1])))
    return tuple(places)
