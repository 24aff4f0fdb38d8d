"""Foraging: robots find food, bring it to the nest, and lay a trail by which others find it."""

import numpy as np

from clean_swarm_env.scenes.baselines import Controller
from clean_swarm_env.scenes.placing import Taken, scattered
from clean_swarm_env.scenes.scene import SCENES, Gradients, Measure, Scene, Setting
from clean_swarm_env.scenes.served import ServedTeam, expertise
from selforg.arrays import Floats

PATCHES, PATCH_RADIUS, NEST_RADIUS = 2, 0.5, 1.5  # [-], [m], [m]
AWAY = 9.0  # [m] least distance of food from the nest
AT_NEST = 1.0
"""Distance from the edge of the nest within which an item counts as brought [m]: a robot's goal radius and more."""
RANDOM_SEARCH = "RandomSearch"
"""Option of the knowledge that is the baseline."""


@SCENES.register
class Foraging(Scene):
    """Patches hold more than robots can bring. An item counts when a robot puts it down at the nest."""

    goal = "Foraging"
    story = "12 robots bring food from 2 patches, 9 m and more away, to a nest on a torus of 900 m2 for 300 s"
    measures = (
        Measure(
            "items brought per minute",
            "1/min",
            "higher",
            10.0,
            "more than a quarter of the 36 that 12 robots could bring that know a way of 10 m",
        ),
    )
    baseline = "random search: the same robots, which never follow a trail"
    setting = Setting(robots=12, seconds=300.0, ground="torus")
    side = 30.0
    apart, start_side = 0.6, 5.0

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        nest = self.ground.centre[None]
        self._food = np.stack(
            [scattered(rng, PATCHES, self.ground, 6.0, side=24.0, free_of=Taken(nest, AWAY)) for rng in chances]
        )
        self._carried = np.zeros(self.arena.rows, dtype=np.bool_)
        self._brought = np.zeros(self.arena.worlds)

    def _around(self) -> tuple[Gradients, ...]:
        nests = np.broadcast_to(self.ground.centre, (self.arena.worlds, 1, 2))
        return (
            Gradients("food", self._food, diffusion=0.0, goal_radius=PATCH_RADIUS),
            Gradients("nest", nests, diffusion=0.0, goal_radius=NEST_RADIUS),
        )

    def _baseline(self) -> Controller:
        return ServedTeam(self, expertise(self.goal, RANDOM_SEARCH))

    def _look(self) -> None:
        assert isinstance(self.controller, ServedTeam)  # the baseline is one too
        carrying = self.controller.memory["carrying"].values == 1.0
        at_nest = self.ground.distances(self.arena.positions, self.ground.centre) < NEST_RADIUS + AT_NEST
        brought = self._carried & ~carrying & at_nest
        self._brought += self.arena.by_world(brought).sum(axis=1)
        self._carried = carrying.copy()

    def _result(self) -> dict[str, Floats]:
        return {"items brought per minute": self._brought / (self.chosen.seconds / 60.0)}
