"""CollisionAvoidance and AgentCollisionAvoidance: go straight across without touching obstacles or each other.

Robots pass through each other and through obstacles, so that a collision is counted and the traffic goes on. Solid
robots would push against each other for ever, which would count as one collision.
"""

import numpy as np

from clean_swarm_env.scenes.arena import CONTROL_PERIOD, Body
from clean_swarm_env.scenes.baselines import Controller, GoStraight, StandStill
from clean_swarm_env.scenes.measures.encounters import Bumps
from clean_swarm_env.scenes.placing import Taken, scattered
from clean_swarm_env.scenes.scene import SCENES, Gradients, Measure, Scene, Setting
from selforg.arrays import Floats
from selforg.elementary import unit_vectors

OBSTACLES, OBSTACLE_RADIUS = 12, 0.5  # [-], [m]
PROGRESS = Measure(
    "progress on the errand", "m/s", "higher", 0.5, "half of the full speed: standing still avoids too", guard=True
)


class Crossing(Scene):
    """Robots that go straight on for ever, in their headings at the start."""

    baseline = "everybody goes straight on and avoids nothing"
    body = Body(contacts="pass_through")
    apart = 1.5

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        self._directions = self.arena.headings.copy()
        self._wanted = np.stack(unit_vectors(self._directions), axis=1)
        self._before = self.arena.positions.copy()
        self._advance = np.zeros(self.arena.rows)

    def _with_errand(self, controller: Controller) -> Controller:
        return controller.with_errand(GoStraight(self.arena, self._directions))

    def _baseline(self) -> Controller:
        return StandStill(self.arena)  # without the mechanism only the errand is left

    def _look(self) -> None:
        steps = self.ground.offsets(self._before, self.arena.positions)
        self._advance += (steps * self._wanted).sum(axis=1)
        self._before[:] = self.arena.positions

    @property
    def _progress(self) -> Floats:
        """Advance (W,) in the wanted direction so far by the time of the whole run: at the end a mean speed [m/s]."""
        speed: Floats = self.arena.by_world(self._advance).mean(axis=1) / (self.chosen.ticks * CONTROL_PERIOD)
        return speed

    @property
    def _robot_minutes(self) -> float:
        return self.chosen.robots * self.chosen.seconds / 60.0


@SCENES.register
class CrossingObstacles(Crossing):
    """Obstacles and other robots are in the way."""

    goal = "CollisionAvoidance"
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
    setting = Setting(robots=5, seconds=120.0, ground="torus")
    side = 15.0

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        super()._prepare(chances)
        starts = self.positions
        self._obstacles = np.stack(
            [
                scattered(rng, OBSTACLES, self.ground, 2.0, free_of=Taken(starts[world], 1.6))
                for world, rng in enumerate(chances)
            ]
        )
        self._bumps = Bumps(self._obstacles, OBSTACLE_RADIUS + self.body.radius, self.ground)

    def _around(self) -> tuple[Gradients, ...]:
        return (Gradients("obstacle", self._obstacles, -1, diffusion=1.0, goal_radius=OBSTACLE_RADIUS),)

    def _look(self) -> None:
        super()._look()
        self._bumps.look(self.positions)

    def _result(self) -> dict[str, Floats]:
        events = self._bumps.events + 2 * self.arena.collisions.events[:, 0]  # both robots of a pair have collided
        return {"collisions per robot and minute": events / self._robot_minutes, PROGRESS.name: self._progress}


@SCENES.register
class CrossingRobots(Crossing):
    """Only other robots are in the way."""

    goal = "AgentCollisionAvoidance"
    story = "10 robots cross a torus of 121 m2 for 120 s"
    measures = (
        Measure("collisions per robot and minute", "1/min", "lower", 0.6, "a tenth of the 6.2 that chance gives"),
        PROGRESS,
    )
    setting = Setting(robots=10, seconds=120.0, ground="torus")
    fewest = 2
    side = 11.0

    def _result(self) -> dict[str, Floats]:
        events = 2 * self.arena.collisions.events[:, 0]
        return {"collisions per robot and minute": events / self._robot_minutes, PROGRESS.name: self._progress}
