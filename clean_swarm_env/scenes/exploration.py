"""CollectiveExploration and IndividualExploration: robots see as much ground as possible, as a team or alone."""

import numpy as np

from clean_swarm_env.scenes.measures.coverage import Coverage
from clean_swarm_env.scenes.scene import SCENES, Measure, Scene, Setting
from selforg.arrays import Floats, Ints

ROBOT_SIGHT, PITCH = 0.5, 0.25  # [m]


class ExploringScene(Scene):
    """Robots that look at the ground while they move."""

    def _map_of_rows(self) -> Ints:
        """Return the number (R,) of the map on which each robot draws."""
        return self.arena.world_of_row

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        closed = self.chosen.ground == "torus"
        side = self.ground.side - self.ground.side % PITCH
        self.coverage = Coverage(self._map_of_rows(), side, 0.0, ROBOT_SIGHT, PITCH, closed)

    def _look(self) -> None:
        self.coverage.look(self.arena.positions, self.arena.now)


@SCENES.register
class CollectiveExploration(ExploringScene):
    """The team has one map: an area counts once, whichever robot saw it."""

    goal = "CollectiveExploration"
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
    setting = Setting(robots=6, seconds=60.0, ground="torus")
    side = 20.0

    def _result(self) -> dict[str, Floats]:
        return {"area seen": self.coverage.area}


@SCENES.register
class IndividualExploration(ExploringScene):
    """Every robot has a map of its own, without the areas that others have seen."""

    goal = "IndividualExploration"
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
    setting = Setting(robots=4, seconds=120.0, ground="torus")
    side = 16.0

    def _map_of_rows(self) -> Ints:
        return np.arange(self.arena.rows)

    def _result(self) -> dict[str, Floats]:
        return {"area seen by each robot": self.arena.by_world(self.coverage.area).mean(axis=1)}
