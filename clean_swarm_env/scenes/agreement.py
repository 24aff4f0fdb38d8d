"""FindBarycenter and MaxValue: robots stand still and decide by the messages of the others."""

from typing import ClassVar

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.scenes.arena import BASELINES
from clean_swarm_env.scenes.baselines import Controller, StandStill
from clean_swarm_env.scenes.measures.agreement import connected, in_earshot, rounds_by_calls, rounds_needed
from clean_swarm_env.scenes.measures.order import barycentre
from clean_swarm_env.scenes.placing import any_headings, scattered
from clean_swarm_env.scenes.scene import SCENES, Measure, Scene, Setting
from clean_swarm_env.scenes.served import ServedTeam
from selforg.arrays import Floats, Ints

EARSHOT = 3.0
"""Distance up to which a robot is heard [m], the range of the configurations."""
NETWORK_TRIES = 1000
"""Draws of places until the robots form one network."""
CENTER = 1
"""State of a robot that has elected itself the centre."""


class StandingRobots(Scene):
    """Robots that stand still."""

    def _baseline(self) -> Controller:
        return StandStill(self.arena)

    def _decisions(self) -> tuple[Floats, Ints]:
        """Return what the robots have decided: values and states (W, N)."""
        assert isinstance(self.controller, ServedTeam)  # baselines have no decisions
        values, states = self.controller.decisions()
        return self.arena.by_world(values), self.arena.by_world(states)


@SCENES.register
class FindBarycenter(StandingRobots):
    """The robot nearest to the middle of the team has to elect itself."""

    goal = "FindBarycenter"
    story = "9 robots on 10 m x 10 m find out which of them stands in the middle"
    measures = (
        Measure(
            "distance of the elected robot to the barycentre",
            "m",
            "lower",
            2.0,
            "the nearest of 9 robots on 100 m2 is 1.7 m away on average",
        ),
        Measure("robots elected", "-", "lower", 1.1, "one; two where two stand alike", guard=True),
    )
    baseline = "a robot drawn by lot"
    setting = Setting(robots=9, seconds=5.0, ground="open")
    fewest = 2
    side = 10.0
    torus_side = 25.0
    apart = 0.6

    def _result(self) -> dict[str, Floats]:
        away = self.ground.distances(barycentre(self.positions, self.ground)[:, None], self.positions)
        if not self.served:  # the mean over all draws
            return {self.measures[0].name: away.mean(axis=1), self.measures[1].name: np.ones(len(away))}
        elected = self._decisions()[1] == CENTER
        count = elected.sum(axis=1)
        mean = (away * elected).sum(axis=1) / np.maximum(count, 1)
        error = np.where(count > 0, mean, away.max(axis=1))  # no robot elected: counts as the farthest one
        return {self.measures[0].name: error, self.measures[1].name: count.astype(np.float64)}


@SCENES.register
class MaxValue(StandingRobots):
    """Each robot has measured a value; all robots have to learn the largest one."""

    goal = "MaxValue"
    story = "20 robots on 9 m x 9 m, each heard 3 m far, agree on the largest of their values"
    measures: ClassVar[tuple[Measure, ...]] = (
        Measure("rounds to agreement", "-", "lower", 6.0, "13 m across at 3 m a round, and one for the way around"),
        Measure("rounds beyond the fewest possible", "-", "lower", 1.0, "word needs a round a hop", guard=True),
    )
    baseline = "everybody asks one neighbour a round, drawn by lot"
    setting = Setting(robots=20, seconds=12.0, ground="open")
    fewest = 2
    side = 9.0
    torus_side = 18.0

    def _place(self, rng: np.random.Generator) -> tuple[Floats, Floats]:
        for _ in range(NETWORK_TRIES):
            places = scattered(rng, self.chosen.robots, self.ground, 0.6)
            if connected(in_earshot(places[None], EARSHOT, self.ground)[0]):
                return places, any_headings(rng, self.chosen.robots)
        raise ConfigurationError(f"--robots: expected as many as form a network, got {self.chosen.robots}")

    def _prepare(self, chances: list[np.random.Generator]) -> None:
        self._values = np.stack([rng.uniform(0.0, 100.0, size=self.chosen.robots) for rng in chances])
        self._hears = in_earshot(self.positions, EARSHOT, self.ground)
        self._agreed = np.full(self.arena.worlds, float(self.chosen.ticks))  # rounds; the last one if they never agree

    def _known(self) -> dict[str, Floats | float]:
        return {"measured": self._values.reshape(-1)}

    def _look(self) -> None:
        if not self.served:
            return
        agreed = (self._decisions()[0] == self._values.max(axis=1, keepdims=True)).all(axis=1)
        rounds = self.arena.ticks - 1  # in the first period robots send their own values only
        self._agreed = np.where(agreed, np.minimum(self._agreed, rounds), self._agreed)

    def _result(self) -> dict[str, Floats]:
        if not self.served:
            for world, hears in enumerate(self._hears):
                rng = self.arena.chance(world, BASELINES)
                self._agreed[world] = rounds_by_calls(hears, self._values[world], rng, self.chosen.ticks)
        fewest = [rounds_needed(h, int(v.argmax())) for h, v in zip(self._hears, self._values, strict=True)]
        return {self.measures[0].name: self._agreed, self.measures[1].name: self._agreed - np.array(fewest)}
