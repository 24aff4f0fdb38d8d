"""ExplorationPatrol: robots see every place again and again."""

import numpy as np

from clean_swarm_env.scenes.exploration import PITCH, ROBOT_SIGHT
from clean_swarm_env.scenes.measures.coverage import Coverage
from clean_swarm_env.scenes.scene import SCENES, Measure, Scene, Setting
from selforg.arrays import Floats

SETTLING = 0.5
"""Share of the run before idleness counts: at the start no place has been idle for long."""


@SCENES.register
class ExplorationPatrol(Scene):
    """The idleness of a place is the time since a robot saw it; its mean over the field and the second half counts."""

    goal = "ExplorationPatrol"
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
    setting = Setting(robots=5, seconds=240.0, ground="torus")
    side = 15.0

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        closed = self.chosen.ground == "torus"
        arena = self.arena
        self._coverage = Coverage(arena.world_of_row, self.side, self.ground.corner, ROBOT_SIGHT, PITCH, closed)
        self._idle, self._looks = np.zeros(arena.worlds), 0

    def _look(self) -> None:
        arena = self.arena
        self._coverage.look(arena.positions, arena.now)
        if arena.ticks > SETTLING * self.chosen.ticks:
            self._idle += self._coverage.idleness(arena.now)
            self._looks += 1

    def _result(self) -> dict[str, Floats]:
        idle = self._idle / self._looks if self._looks else self._coverage.idleness(self.arena.now)
        return {"time since a place was seen": idle}
