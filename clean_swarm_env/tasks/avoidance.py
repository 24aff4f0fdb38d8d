"""CollisionAvoidance and AgentCollisionAvoidance: go straight across without touching obstacles or each other.

Robots pass through each other and through obstacles, so that a collision is counted and the traffic goes on. Solid
robots would push against each other for ever, which would count as one collision.
"""

from typing import Annotated, TypeVar

import numpy as np
from pydantic import Field

from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import TaskState, Things, WorldStart
from clean_swarm_env.world.task import Task
from selforg.arrays import KEPT, Flags, Floats, Ints
from selforg.commands import Commands
from selforg.elementary import unit_vectors

OBSTACLE_RADIUS = 0.5  # [m]
PROGRESS = Measure(
    "progress on the errand", "m/s", "higher", 0.5, "half of the full speed: standing still avoids too", guard=True
)


class ObstacleSettings(TaskSettings):
    """Settings of tasks with obstacles."""

    obstacles: Annotated[int, Field(strict=True, ge=1, le=1000)] = 12
    """Number of obstacles."""


class ObstacleState(TaskState):
    """Obstacles of a world, and the robots that touch them."""

    obstacles: Annotated[Floats, "W obstacles 2", KEPT]  # [m]
    touching: Annotated[Flags, "R obstacles", KEPT]
    hits: Annotated[Ints, "W", KEPT]


class CrossingState(TaskState):
    """The errands of robots that go straight on."""

    wanted: Annotated[Floats, "R 2", KEPT]  # direction, a unit vector
    before: Annotated[Floats, "R 2", KEPT]  # places at the end of the period before [m]
    advance: Annotated[Floats, "R", KEPT]  # way in the wanted direction so far [m]


class CrossingObstaclesState(CrossingState, ObstacleState):
    """Errands and obstacles."""


S = TypeVar("S", bound=TaskSettings)
O = TypeVar("O", bound=ObstacleSettings)  # noqa: E741
B = TypeVar("B", bound=ObstacleState)
E = TypeVar("E", bound=CrossingState)


class Obstacles(Task[O, B]):
    """Obstacles lie about; a robot hits one whenever it comes to touch it."""

    def things(self) -> tuple[Things, ...]:
        """Return the obstacles."""
        return (Things("obstacle", self.state.obstacles, -1, diffusion=1.0, goal_radius=OBSTACLE_RADIUS),)

    def after_moving(self) -> None:
        """Count robots that have come to touch an obstacle; those that touch one at first do not count."""
        world, state = self.world, self.state
        away = world.ground.distances(world.positions[:, :, None], state.obstacles[:, None])
        touching = away < OBSTACLE_RADIUS + world.by_world(world.of_each("radius"))[:, :, None]
        new = touching & ~world.by_world(state.touching)
        state.hits += np.where(world.ticks > 1, new.sum(axis=(1, 2)), 0)
        state.touching[:] = touching.reshape(state.touching.shape)


class Crossing(Task[S, E]):
    """Robots that go straight on for ever, in their headings at the start."""

    baseline = "everybody goes straight on and avoids nothing"
    apart = 1.5

    def place(self, start: WorldStart) -> None:
        """Put robots anywhere; their headings are where they want to go."""
        super().place(start)
        self.state.wanted[start.rows] = np.stack(unit_vectors(start.poses[:, 2]), axis=1)
        self.state.before[start.rows] = start.places

    def command(self, commands: Commands) -> None:
        """Command the errand where a mechanism bends it."""
        commands.clear()
        commands.commanded[:] = self.world.steers
        commands.vectors[:] = self.world.max_speed * self.state.wanted

    def bend(self, commands: Commands) -> None:
        """Add the errand to the commands of other mechanisms."""
        adding = ~self.world.steers
        commands.vectors[adding & ~commands.commanded] = 0.0
        commands.vectors[adding] += (self.world.max_speed * self.state.wanted)[adding]
        commands.commanded[adding], commands.in_place[adding] = True, False

    def command_baseline(self, commands: Commands) -> None:
        """Go straight on."""
        commands.vectors[:] = self.world.max_speed * self.state.wanted
        commands.commanded[:] = True

    def after_moving(self) -> None:
        """Count the progress of robots."""
        positions, state = self.world.floor.physics.positions, self.state
        state.advance += (self.world.ground.offsets(state.before, positions) * state.wanted).sum(axis=1)
        state.before[:] = positions

    @property
    def progress(self) -> Floats:
        """Advance (W,) in the wanted direction so far by the time of the whole mission: at the end a speed [m/s]."""
        world = self.world
        speed: Floats = world.by_world(self.state.advance).mean(axis=1) / (world.limits * world.period)
        return speed


@TASKS.register
class CrossingObstacles(
    Crossing[ObstacleSettings, CrossingObstaclesState], Obstacles[ObstacleSettings, CrossingObstaclesState]
):
    """Obstacles and other robots are in the way."""

    name = "CollisionAvoidance"
    story = "5 robots cross a torus of 225 m2 with 12 obstacles for 120 s"
    measures = (
        Measure(
            "collisions per robot and minute",
            "1/min",
            "lower",
            0.7,
            "a tenth of what chance gives: 4.8 with obstacles, 1.5 with robots",
        ),
        PROGRESS,
    )
    mission = {
        "world": {"width": 15.0, "height": 15.0, "contacts": "pass_through"},
        "robots": {"count": 5},
        "time_limit": 120.0,
    }

    def place(self, start: WorldStart) -> None:
        """Put obstacles where no robot starts."""
        super().place(start)
        self.state.obstacles[start.world] = start.scattered(self.settings.obstacles, 2.0, free_of=start.places, gap=1.6)

    def after_moving(self) -> None:
        """Count the progress of robots, and the obstacles that they hit."""
        Crossing.after_moving(self)
        Obstacles.after_moving(self)

    def result(self) -> dict[str, Floats]:
        """Return collisions with obstacles and robots, and the progress."""
        events = self.state.hits + 2 * self.world.collisions  # both robots of a pair have collided
        return {"collisions per robot and minute": events / self.world.robot_minutes, PROGRESS.name: self.progress}


@TASKS.register
class AgentCollisionAvoidance(Crossing[TaskSettings, CrossingState]):
    """Only other robots are in the way."""

    story = "10 robots cross a torus of 121 m2 for 120 s"
    measures = (
        Measure("collisions per robot and minute", "1/min", "lower", 0.6, "a tenth of the 6.2 that chance gives"),
        PROGRESS,
    )
    mission = {"world": {"contacts": "pass_through"}, "robots": {"count": 10}, "time_limit": 120.0}
    fewest = 2

    def result(self) -> dict[str, Floats]:
        """Return collisions with robots, and the progress."""
        world = self.world
        collisions = 2 * world.collisions / world.robot_minutes
        return {"collisions per robot and minute": collisions, PROGRESS.name: self.progress}
