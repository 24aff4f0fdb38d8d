"""What missions, starts and families know of cleaning: impossible places, and random draws."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from clean_swarm_env.config.events import Land, MoveSpots, MoveStations, Respawn
from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.free_places import check_place
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import StartsFile
from clean_swarm_env.config.tasks import expected_items, rows_only
from clean_swarm_env.config.types import Point
from clean_swarm_env.tasks.cleaning.draws import Room, draw_events, random_spots, random_stations
from clean_swarm_env.tasks.cleaning.settings import CleaningSettings, settings_of
from selector.documents.errors import impossible

NOWHERE: Final[Point] = (0.0, 0.0)
"""Place of stations that are not placed yet [m]."""


def check(mission: MissionConfig) -> None:
    """Raise the error of the first place that robots cannot reach, or of too little room for items."""
    world, task = mission.world, settings_of(mission)
    if world.ground == "open":
        raise impossible("world.ground", "a torus or a walled field with the task Cleaning", world.ground)
    ground = "torus" if world.ground == "torus" else "field"
    for key, (x, y) in _places(mission).items():
        if not (0.0 <= x <= world.width and 0.0 <= y <= world.height):
            expected = f"a point on the {ground} {world.width:g} m x {world.height:g} m"
            raise impossible(key, expected, f"[{x:g}, {y:g}]")
        apart = 0.0 if "spots" in key else task.stations.reach  # robots at a station have no wall before it
        check_place(key, (x, y), world, mission.robots.radius, apart)
    least = expected_items(mission)
    if 0 < task.garbage.capacity < least:
        expected = f"0 or at least {least}, the items at the start and those that land"
        raise impossible("task.garbage.capacity", expected, task.garbage.capacity)


def frame_settings(mission: MissionConfig) -> CleaningSettings:
    """Return the settings without places of stations and harmless collisions, and with rows of items only."""
    task = rows_only(settings_of(mission), mission)
    stations = task.stations.at((NOWHERE,) * len(task.stations.places))
    harmful = task.consequences.model_copy(update={"harmless": False})
    return task.model_copy(update={"stations": stations, "consequences": harmful})


def draw_scenario(
    family: FamilyConfig, size: Point, robots: int, rng: np.random.Generator
) -> tuple[CleaningSettings, list[dict[str, Any]]]:
    """Return settings with random items and, where the family says so, random stations and spots; random events."""
    task, room = settings_of(family.mission), Room.of(family.mission, size)
    items = int(rng.integers(family.items[0], family.items[1] + 1))
    respawn = float(rng.uniform(*family.respawn))
    stations = task.stations.at(_station_places(family, room, rng)) if family.stations == "random" else task.stations
    spots = task.garbage.spots
    if family.spots is not None:
        spots = random_spots(int(rng.integers(family.spots[0], family.spots[1] + 1)), room, rng)
    events = draw_events(family.changes, room, robots, len(spots), family.mission.time_limit, rng)
    lying = {"count": items, "respawn": respawn, "spots": spots, "capacity": _rows_of_items(family)}
    drawn = {"garbage": task.garbage.model_copy(update=lying), "stations": stations}
    if family.harmless > 0.0:
        harmless = bool(rng.uniform() < family.harmless)
        drawn["consequences"] = task.consequences.model_copy(update={"harmless": harmless})
    return task.model_copy(update=drawn), events


def _places(mission: MissionConfig) -> dict[str, Point]:
    """Return the places [m] of stations and spots by their keys, those of events included."""
    task = settings_of(mission)
    places = {"task.stations.recycling": task.stations.recycling, "task.stations.dump": task.stations.dump}
    for key in ("further_recycling", "further_dumps"):
        places |= {f"task.stations.{key}.{k}": place for k, place in enumerate(getattr(task.stations, key))}
    places |= {f"task.garbage.spots.{k}": spot for k, spot in enumerate(task.garbage.spots)}
    for k, event in enumerate(mission.events):
        if isinstance(event, MoveSpots):
            places |= {f"events.{k}.spots.{n}": spot for n, spot in enumerate(event.spots)}
        elif isinstance(event, MoveStations):
            places |= {f"events.{k}.recycling": event.recycling, f"events.{k}.dump": event.dump}
    return places


def _station_places(family: FamilyConfig, room: Room, rng: np.random.Generator) -> tuple[Point, ...]:
    """Return random places of all stations in the `room`, in the order of `StationsConfig.places`."""
    stations = settings_of(family.mission).stations
    if family.station_places is None:
        return random_stations(len(stations.kinds), room, rng)
    number = int(rng.integers(family.station_places[0], family.station_places[1] + 1))
    drawn = random_stations(2 * number, room, rng)  # recycling and dump in turn
    kinds = zip(stations.earlier, stations.kinds, strict=True)
    return tuple(drawn[2 * (k % number) + kind] for k, kind in kinds)


def _rows_of_items(family: FamilyConfig) -> int:
    """Return the number of rows for items in which every scenario of a family has room."""
    events, most = family.mission.events, family.items[1]
    landing = sum(event.items for event in events if isinstance(event, Land))
    coming = "respawn" in family.changes.kinds or any(isinstance(event, Respawn) for event in events)
    continuous = family.respawn[1] > 0.0 or coming
    capacity = settings_of(family.mission).garbage.capacity
    return max(most + landing, capacity or (4 * most if continuous else 0))


class CleaningStarts(StartsFile):
    """A file of start configurations with its torus and stations."""

    recycling: Point
    """Position of the recycling station [m]."""
    dump: Point
    """Position of the dump station [m]."""

    def task_of(self, mission: MissionConfig) -> CleaningSettings:
        """Return the settings with the stations of this file."""
        task = settings_of(mission)
        stations = task.stations.model_copy(update={"recycling": self.recycling, "dump": self.dump})
        return task.model_copy(update={"stations": stations})
