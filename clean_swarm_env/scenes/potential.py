"""FollowPotentialField and FollowMaxPotential: robots climb a field of gradients, or find the widest one."""

import numpy as np

from clean_swarm_env.scenes.baselines import Controller, GoTo
from clean_swarm_env.scenes.measures.field import Field, height
from clean_swarm_env.scenes.placing import Taken, scattered
from clean_swarm_env.scenes.scene import SCENES, Gradients, Measure, Scene, Setting
from selforg.arrays import Floats

HOLLOW, HILL = 15.0, 2.0  # [m] diffusion of the attractive gradient and of the repulsive ones
HILLS, START_FROM_TOP = 5, 5.0  # [-], [m]
SOURCE_REACHES = (8.0, 11.0, 14.0)  # [m] diffusion of the three sources
SOURCE_RADIUS = 1.5  # [m] goal radius of a source: room for all


@SCENES.register
class FollowPotentialField(Scene):
    """Robots climb a potential whose slope is the forces of the gradients; height 0 is the top."""

    goal = "FollowPotentialField"
    story = "6 robots climb a field of one attractive and 5 repulsive gradients for 90 s"
    measures = (
        Measure("share of the height climbed", "-", "higher", 0.9, "a tenth is left to those that wait for a place"),
    )
    setting = Setting(robots=6, seconds=90.0, ground="torus")
    side = 16.0
    away = START_FROM_TOP

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        top = self.ground.centre[None]
        hills = [scattered(rng, HILLS, self.ground, 2.0, side=12.0, free_of=Taken(top, 4.0)) for rng in chances]
        self._hills = np.stack(hills)
        tops = np.broadcast_to(self.ground.centre, (self.arena.worlds, 1, 2))
        self._field = Field(
            np.concatenate([tops, self._hills], axis=1),
            np.array([1.0] + [-1.0] * HILLS),
            np.array([HOLLOW] + [HILL] * HILLS),
            np.array([SOURCE_RADIUS] + [0.0] * HILLS),
        )
        self._start = self._height()

    def _height(self) -> Floats:
        """Return the mean height (W,) [m] of the robots."""
        mean: Floats = height(self._field, self.positions, self.body.pose_goal_radius, self.ground).mean(axis=1)
        return mean

    def _around(self) -> tuple[Gradients, ...]:
        field = self._field
        return (
            Gradients("field", field.places[:, :1], +1, diffusion=HOLLOW, goal_radius=SOURCE_RADIUS),
            Gradients("field", self._hills, -1, diffusion=HILL),
        )

    def _result(self) -> dict[str, Floats]:
        return {"share of the height climbed": 1.0 - self._height() / self._start}


@SCENES.register
class FollowMaxPotential(Scene):
    """Robots have to find the source that reaches farthest of three, though another one may be nearer."""

    goal = "FollowMaxPotential"
    story = "6 robots among three sources find the one that reaches farthest within 120 s"
    measures = (Measure("robots at the source of most reach", "-", "higher", 0.9, "all but a late one in two runs"),)
    baseline = "everybody goes to the source that is nearest at the start"
    setting = Setting(robots=6, seconds=120.0, ground="open")
    side = 14.0
    torus_side = 28.0

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        self._sources = np.stack([scattered(rng, len(SOURCE_REACHES), self.ground, 6.0) for rng in chances])

    def _around(self) -> tuple[Gradients, ...]:
        return (Gradients("field", self._sources, +1, diffusion=np.array(SOURCE_REACHES), goal_radius=SOURCE_RADIUS),)

    def _baseline(self) -> Controller:
        away = self.ground.distances(self.positions[:, :, None], self._sources[:, None])
        nearest = np.take_along_axis(self._sources, away.argmin(axis=2)[..., None], axis=1)
        return GoTo(self.arena, nearest.reshape(-1, 2), SOURCE_RADIUS + self.body.pose_goal_radius)

    def _result(self) -> dict[str, Floats]:
        away = self.ground.distances(self.positions, self._sources[:, None, int(np.argmax(SOURCE_REACHES))])
        there = away <= SOURCE_RADIUS + self.body.pose_goal_radius + self.body.radius
        return {"robots at the source of most reach": there.mean(axis=1)}
