"""ReachGoal: robots get to one place, around obstacles."""

import numpy as np

from clean_swarm_env.scenes.avoidance import OBSTACLE_RADIUS
from clean_swarm_env.scenes.measures.encounters import Bumps
from clean_swarm_env.scenes.placing import Taken, scattered
from clean_swarm_env.scenes.scene import SCENES, Gradients, Measure, Scene, Setting
from selforg.arrays import Floats

OBSTACLES_BETWEEN = 8
GOAL_AREA_RADIUS, START_AWAY = 2.0, 8.0  # [m]; room for all around the goal
OFF_GOAL, OFF_START = 4.5, 2.2  # [m] from obstacles: they repel no robot at the goal or at its start
FIELD = 20.0  # [m]


@SCENES.register
class ReachGoal(Scene):
    """Robots start around the goal, at least START_AWAY from it; obstacles lie in between."""

    goal = "ReachGoal"
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
    setting = Setting(robots=6, seconds=90.0, ground="torus")
    side = FIELD

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        goal = self.ground.centre[None]
        self._obstacles = np.empty((self.arena.worlds, OBSTACLES_BETWEEN, 2))
        for world, rng in enumerate(chances):
            taken = np.concatenate([goal, self.positions[world]])
            gaps = np.array([OFF_GOAL] + [OFF_START] * self.chosen.robots)
            self._obstacles[world] = scattered(
                rng, OBSTACLES_BETWEEN, self.ground, 3.0, side=14.0, free_of=Taken(taken, gaps)
            )
        self._bumps = Bumps(self._obstacles, OBSTACLE_RADIUS + self.body.radius, self.ground)

    def _around(self) -> tuple[Gradients, ...]:
        goals = np.broadcast_to(self.ground.centre, (self.arena.worlds, 1, 2))
        return (
            Gradients("goal", goals, +1, diffusion=FIELD, goal_radius=GOAL_AREA_RADIUS),
            Gradients("obstacle", self._obstacles, -1, diffusion=1.0, goal_radius=OBSTACLE_RADIUS),
        )

    def _look(self) -> None:
        self._bumps.look(self.positions)

    def _result(self) -> dict[str, Floats]:
        away = self.ground.distances(self.positions, self.ground.centre)
        clearance = np.maximum(away - self.body.pose_goal_radius - GOAL_AREA_RADIUS, 0.0)
        minutes = self.chosen.seconds / 60.0
        return {
            "distance to the goal area": clearance.mean(axis=1),
            "obstacles hit per robot and minute": self._bumps.events / (self.chosen.robots * minutes),
        }
