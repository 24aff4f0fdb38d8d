"""ReachGoal: robots get to one place, around obstacles."""

from typing import Annotated

import numpy as np
from pydantic import Field

from clean_swarm_env.config.tasks import TASKS
from clean_swarm_env.tasks.avoidance import Obstacles, ObstacleSettings, ObstacleState
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import Things, WorldStart
from selforg.arrays import Floats

GOAL_AREA_RADIUS, START_AWAY = 2.0, 8.0  # [m]; room for all around the goal
OFF_GOAL, OFF_START = 4.5, 2.2  # [m] from obstacles: they repel no robot at the goal or at its start
FIELD = 20.0  # [m]


class BetweenSettings(ObstacleSettings):
    """The obstacles between the robots and the goal."""

    obstacles: Annotated[int, Field(strict=True, ge=1, le=1000)] = 8


@TASKS.register
class ReachGoal(Obstacles[BetweenSettings, ObstacleState]):
    """Robots start around the goal, at least START_AWAY from it; obstacles lie in between.

    The baseline is that of `Task`, a random walk.
    """

    story = "6 robots, 8 m and more from the goal, get to it around 8 obstacles"
    measures = (
        Measure("distance to the goal area", "m", "lower", 0.5, "a robot's length beyond touching it"),
        Measure(
            "obstacles hit per robot and minute",
            "1/min",
            "lower",
            0.3,
            "a tenth of what going straight through them gives by chance",
            guard=True,
        ),
    )
    mission = {"world": {"width": FIELD, "height": FIELD}, "robots": {"count": 6}, "time_limit": 90.0}
    away = START_AWAY

    def place(self, start: WorldStart) -> None:
        """Put robots around the goal, and obstacles between them and it."""
        super().place(start)
        taken = np.concatenate([start.ground.centre[None], start.places])
        gaps = np.array([OFF_GOAL] + [OFF_START] * start.robots)
        self.state.obstacles[start.world] = start.scattered(self.settings.obstacles, 3.0, 14.0, free_of=taken, gap=gaps)

    def things(self) -> tuple[Things, ...]:
        """Return the goal and the obstacles."""
        goal = Things("goal", self.world.centres, diffusion=FIELD, goal_radius=GOAL_AREA_RADIUS)
        return (goal, *super().things())

    def result(self) -> dict[str, Floats]:
        """Return how far the robots are from the goal, and how many obstacles they have hit."""
        world, own = self.world, self.world.by_world(self.world.of_each("pose_goal_radius"))
        away = world.ground.distances(world.positions, world.ground.centre)
        return {
            "distance to the goal area": np.maximum(away - own - GOAL_AREA_RADIUS, 0.0).mean(axis=1),
            "obstacles hit per robot and minute": self.state.hits / world.robot_minutes,
        }
