"""FormationControl and CircleFormation: robots move as a flock, or stand in a circle."""

import numpy as np

from clean_swarm_env.scenes.arena import CONTROL_PERIOD, Body
from clean_swarm_env.scenes.baselines import Controller, GoStraight, Instead, StandStill
from clean_swarm_env.scenes.measures.order import gap_spread, nearest_neighbours, polarisation, radial_spread
from clean_swarm_env.scenes.placing import scattered
from clean_swarm_env.scenes.scene import SCENES, Gradients, Measure, Scene, Setting
from selforg.arrays import Floats

SPACING = 1.5
"""Distance at which flocking robots want their neighbours [m]: the reach of their pose gradient."""
CIRCLE = 3.5
"""Goal radius of the beacon [m]; robots stand their own one farther away."""
SET_OUT = 0.4
"""Speed of the robots at the start [m/s]."""
LAST = 10.0
"""Seconds at the end over which the order of a flock is averaged."""


@SCENES.register
class FormationControl(Scene):
    """Robots that move in all directions form a flock, which keeps their mean momentum."""

    goal = "FormationControl"
    story = "12 robots on 4 m x 4 m set out in any direction of one half and become a flock within 60 s"
    measures = (
        Measure("polarisation", "-", "higher", 0.9, "headings in one half give 0.66, all the same 1"),
        Measure("error of spacing", "m", "lower", 0.3, "a fifth of the wanted distance of 1.5 m to the nearest"),
    )
    baseline = "everybody goes straight on"
    setting = Setting(robots=12, seconds=60.0, ground="open")
    fewest = 2
    side = 4.0
    torus_side = 20.0
    body = Body(drive="holonomic")

    def _place(self, rng: np.random.Generator) -> tuple[Floats, Floats]:
        places = scattered(rng, self.chosen.robots, self.ground, 0.8)
        return places, rng.uniform(-0.5 * np.pi, 0.5 * np.pi, size=self.chosen.robots)

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        self._directions = self.arena.headings.copy()
        self._order, self._error = np.zeros(self.arena.worlds), np.zeros(self.arena.worlds)
        self._looks = 0

    def _with_errand(self, controller: Controller) -> Controller:
        # A flock keeps its momentum: robots that start at rest would stay at rest.
        return Instead(controller, GoStraight(self.arena, self._directions, SET_OUT))

    def _baseline(self) -> Controller:
        return StandStill(self.arena)

    def _look(self) -> None:
        if (self.chosen.ticks - self.arena.ticks) * CONTROL_PERIOD >= LAST:
            return
        order, error = self._present()
        self._order += order
        self._error += error
        self._looks += 1

    def _present(self) -> tuple[Floats, Floats]:
        """Return polarisation and error of spacing (W,) of this moment."""
        nearest = nearest_neighbours(self.positions, self.ground)
        return polarisation(self.headings), np.abs(nearest - SPACING).mean(axis=1)

    def _result(self) -> dict[str, Floats]:
        sums = (self._order / self._looks, self._error / self._looks) if self._looks else self._present()
        return dict(zip(("polarisation", "error of spacing"), sums, strict=True))


@SCENES.register
class CircleFormation(Scene):
    """Robots form a ring around a beacon."""

    goal = "CircleFormation"
    story = "10 robots on 8 m x 8 m form a circle around a beacon in the middle within 90 s"
    measures = (
        Measure("spread of distances to the centre", "m", "lower", 0.25, "the radius of a robot"),
        Measure("spread of angles between neighbours", "rad", "lower", 0.31, "half of the even angle 2 pi / 10"),
    )
    baseline = "everybody stays where it is"
    setting = Setting(robots=10, seconds=90.0, ground="open")
    fewest = 2
    side = 8.0
    torus_side = 16.0
    body = Body(pose_diffusion=1.5)

    def _around(self) -> tuple[Gradients, ...]:
        beacons = np.broadcast_to(self.ground.centre, (self.arena.worlds, 1, 2))
        return (Gradients("centre", beacons, +1, diffusion=5.0, goal_radius=CIRCLE),)

    def _baseline(self) -> Controller:
        return StandStill(self.arena)

    def _result(self) -> dict[str, Floats]:
        centre = self.ground.centre
        return {
            "spread of distances to the centre": radial_spread(self.positions, centre, self.ground),
            "spread of angles between neighbours": gap_spread(self.positions, centre, self.ground),
        }
