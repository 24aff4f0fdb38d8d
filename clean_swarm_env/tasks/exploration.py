"""CollectiveExploration, IndividualExploration and ExplorationPatrol: robots look at as much ground as possible."""

from collections.abc import Mapping
from typing import Annotated, TypeVar

import numpy as np

from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.tasks.measures.coverage import UNSEEN, area, idleness, mark
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import TaskState, WorldStart
from clean_swarm_env.world.task import Task
from selforg.arrays import KEPT, Floats, Ints

ROBOT_SIGHT, PITCH = 0.5, 0.25  # [m]
MOST_MAPPED = 2**27
"""Most cells of all maps of a batch: they take a gigabyte."""
SETTLING = 0.5
"""Share of the mission before idleness counts: at the start no place has been idle for long."""


class TeamMap(TaskState):
    """A map for each world."""

    seen: Annotated[Floats, "W cells cells", KEPT]  # when each cell was last seen [s], or UNSEEN


class OwnMaps(TaskState):
    """A map for each robot."""

    seen: Annotated[Floats, "R cells cells", KEPT]


class PatrolledMap(TeamMap):
    """A map for each world, and the idleness of its places."""

    idle: Annotated[Floats, "W", KEPT]  # sum of mean idlenesses [s]
    looks: Annotated[Ints, "W", KEPT]


Map = TypeVar("Map", TeamMap, OwnMaps, PatrolledMap)


class Looking(Task[TaskSettings, Map]):
    """Robots look at the ground while they move; they draw on the map of their world, or on their own."""

    def sizes(self) -> Mapping[str, int]:
        """Return the cells of a map along a side; ConfigurationError if all maps have no room in memory."""
        cells, maps = int(self.mapped // PITCH), len(np.unique(self.maps))
        if maps * cells * cells > MOST_MAPPED:
            most = PITCH * int((MOST_MAPPED / maps) ** 0.5)
            expected = f"at most {most:g} m on each side that robots can reach"
            raise ConfigurationError(f"world: expected {expected} with the task {self.name}, got {self.mapped:g}")
        return {"cells": cells}

    @property
    def mapped(self) -> float:
        """Side of the square that is mapped, around the middle [m]: all ground that robots can reach."""
        return float(self.world.ground.land.min())

    @property
    def maps(self) -> Ints:
        """Number (R,) of the map on which each robot draws."""
        return self.world.of_row

    def place(self, start: WorldStart) -> None:
        """Begin with empty maps."""
        super().place(start)
        self.state.seen[np.unique(self.maps[self.world.of_row == start.world])] = UNSEEN

    def after_moving(self) -> None:
        """Look at the ground."""
        world, seen = self.world, self.state.seen
        corner = world.ground.centre - 0.5 * self.mapped
        closed, now = world.ground.kind == "torus", world.seconds[world.of_row]
        mark(world.floor.physics.positions, self.maps, now, corner, ROBOT_SIGHT, PITCH, closed, seen)


@TASKS.register
class CollectiveExploration(Looking[TeamMap]):
    """The team has one map: an area counts once, whichever robot saw it."""

    story = "6 robots that see 0.5 m far look at a torus of 400 m2 for 60 s"
    measures = (
        Measure(
            "area seen",
            "m2",
            "higher",
            237.0,
            "what as many straight independent paths see by chance, 400 (1 - exp(-360 / 400))",
        ),
    )
    mission = {"world": {"width": 20.0, "height": 20.0}, "robots": {"count": 6}, "time_limit": 60.0}

    def result(self) -> dict[str, Floats]:
        """Return the area that the team has seen."""
        return {"area seen": area(self.state.seen, PITCH)}


@TASKS.register
class IndividualExploration(Looking[OwnMaps]):
    """Every robot has a map of its own, without the areas that others have seen."""

    story = "4 robots that see 0.5 m far look at a torus of 256 m2 for 120 s, each for itself"
    measures = (
        Measure(
            "area seen by each robot",
            "m2",
            "higher",
            96.0,
            "what a straight path sees by chance, 256 (1 - exp(-120 / 256))",
        ),
    )
    mission = {"world": {"width": 16.0, "height": 16.0}, "robots": {"count": 4}, "time_limit": 120.0}

    @property
    def maps(self) -> Ints:
        """Number (R,) of the map on which each robot draws: its own."""
        return np.arange(self.world.rows)

    def result(self) -> dict[str, Floats]:
        """Return the mean area that a robot has seen."""
        return {"area seen by each robot": self.world.by_world(area(self.state.seen, PITCH)).mean(axis=1)}


@TASKS.register
class ExplorationPatrol(Looking[PatrolledMap]):
    """The idleness of a place is the time since a robot saw it; its mean over the ground and the second half counts."""

    story = "5 robots that see 0.5 m far patrol a torus of 225 m2 for 240 s"
    measures = (
        Measure(
            "time since a place was seen",
            "s",
            "lower",
            45.0,
            "straight independent paths: 225 m2 seen at 5 m2/s, by chance; a perfect round trip gives half",
        ),
    )
    mission = {"world": {"width": 15.0, "height": 15.0}, "robots": {"count": 5}, "time_limit": 240.0}

    @property
    def mapped(self) -> float:
        """Side of the square that is to be patrolled [m]."""
        return float(self.world.ground.size.min())

    def after_moving(self) -> None:
        """Look at the ground, and add how long its places have been idle."""
        super().after_moving()
        world, state = self.world, self.state
        counts = world.ticks > SETTLING * world.limits
        if counts.any():
            state.idle += np.where(counts, idleness(state.seen, world.seconds), 0.0)
            state.looks += counts

    def result(self) -> dict[str, Floats]:
        """Return the mean idleness of places."""
        state = self.state
        mean = state.idle / np.maximum(state.looks, 1)
        return {
            "time since a place was seen": np.where(state.looks > 0, mean, idleness(state.seen, self.world.seconds))
        }
