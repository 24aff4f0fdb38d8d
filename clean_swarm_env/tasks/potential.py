"""FollowPotentialField and FollowMaxPotential: robots climb a field of gradients, or find the widest one."""

from typing import Annotated

import numpy as np

from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.tasks.measures.field import Field, height
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import TaskState, Things, WorldStart
from clean_swarm_env.world.task import Task
from selforg.arrays import KEPT, Floats
from selforg.commands import Commands

HOLLOW, HILL = 15.0, 2.0  # [m] diffusion of the attractive gradient and of the repulsive ones
HILLS = 5
SOURCE_REACHES = (8.0, 11.0, 14.0)  # [m] diffusion of the three sources
SOURCE_RADIUS = 1.5  # [m] goal radius of a source: room for all


class Hills(TaskState):
    """Repulsive gradients of each world, and how high its robots stood at the start."""

    places: Annotated[Floats, "W 5 2", KEPT]  # [m]
    start: Annotated[Floats, "W", KEPT]  # mean height of the robots [m]


class Sources(TaskState):
    """Attractive gradients of each world, and those that were nearest to its robots at the start."""

    places: Annotated[Floats, "W 3 2", KEPT]  # [m]
    nearest: Annotated[Floats, "R 2", KEPT]  # [m]


@TASKS.register
class FollowPotentialField(Task[TaskSettings, Hills]):
    """Robots climb a potential whose slope is the forces of the gradients; height 0 is the top."""

    story = "6 robots climb a field of one attractive and 5 repulsive gradients for 90 s"
    measures = (
        Measure("share of the height climbed", "-", "higher", 0.9, "a tenth is left to those that wait for a place"),
    )
    mission = {"world": {"width": 16.0, "height": 16.0}, "robots": {"count": 6}, "time_limit": 90.0}
    away = 5.0

    def place(self, start: WorldStart) -> None:
        """Put robots away from the top, and hills between."""
        super().place(start)
        self.state.places[start.world] = start.scattered(HILLS, 2.0, 12.0, 4.0)
        self.state.start[start.world] = self._height(start.world, start.places[None])[0]

    def _height(self, world: int | slice, positions: Floats) -> Floats:
        """Return the mean height (K,) [m] of robots at positions (K, N, 2) in the field of some worlds."""
        ground, hills = self.world.ground, np.atleast_3d(self.state.places[world]).reshape(-1, HILLS, 2)
        tops = np.broadcast_to(ground.centre, (len(hills), 1, 2))
        field = Field(
            np.concatenate([tops, hills], axis=1),
            np.array([1.0] + [-1.0] * HILLS),
            np.array([HOLLOW] + [HILL] * HILLS),
            np.array([SOURCE_RADIUS] + [0.0] * HILLS),
        )
        own = self.world.mission.of_each("pose_goal_radius")[:, None]
        mean: Floats = height(field, positions, own, ground).mean(axis=1)
        return mean

    def things(self) -> tuple[Things, ...]:
        """Return the gradients of the field."""
        return (
            Things("field", self.world.centres, diffusion=HOLLOW, goal_radius=SOURCE_RADIUS),
            Things("field", self.state.places, -1, diffusion=HILL),
        )

    def result(self) -> dict[str, Floats]:
        """Return how much of its height at the start the team has climbed."""
        now = self._height(slice(None), self.world.positions)
        first = np.where(self.state.start == 0.0, 1.0, self.state.start)
        return {"share of the height climbed": 1.0 - now / first}


@TASKS.register
class FollowMaxPotential(Task[TaskSettings, Sources]):
    """Robots have to find the source that reaches farthest of three, though another one may be nearer."""

    story = "6 robots among three sources find the one that reaches farthest within 120 s"
    measures = (Measure("robots at the source of most reach", "-", "higher", 0.9, "all but a late one in two runs"),)
    baseline = "everybody goes to the source that is nearest at the start"
    mission = {
        "world": {"ground": "open", "width": 28.0, "height": 28.0},
        "robots": {"count": 6},
        "time_limit": 120.0,
    }
    start_side = 14.0

    def place(self, start: WorldStart) -> None:
        """Put robots and sources anywhere."""
        super().place(start)
        sources = start.scattered(len(SOURCE_REACHES), 6.0, 14.0)
        self.state.places[start.world] = sources
        away = start.ground.distances(start.places[:, None], sources)
        self.state.nearest[start.rows] = sources[away.argmin(axis=1)]

    def things(self) -> tuple[Things, ...]:
        """Return the sources."""
        return (Things("field", self.state.places, 1, np.array(SOURCE_REACHES), SOURCE_RADIUS),)

    def command_baseline(self, commands: Commands) -> None:
        """Go to the source that was nearest at the start, and stop at it."""
        offsets = self.world.ground.offsets(self.world.floor.physics.positions, self.state.nearest)
        away = np.linalg.norm(offsets, axis=1, keepdims=True)
        unit = offsets / np.maximum(away, 1e-12)
        commands.vectors[:] = np.where(away > self._at_source[:, None], self.world.max_speed * unit, 0.0)
        commands.commanded[:] = True

    @property
    def _at_source(self) -> Floats:
        return SOURCE_RADIUS + self.world.of_each("pose_goal_radius")

    def result(self) -> dict[str, Floats]:
        """Return the share of robots at the source that reaches farthest."""
        best = self.state.places[:, None, int(np.argmax(SOURCE_REACHES))]
        away = self.world.ground.distances(self.world.positions, best)
        there = away <= self.world.by_world(self._at_source + self.world.of_each("radius"))
        return {"robots at the source of most reach": there.mean(axis=1)}
