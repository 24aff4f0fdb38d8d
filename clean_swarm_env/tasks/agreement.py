"""FindBarycenter and MaxValue: robots stand still and decide by the messages of the others."""

from typing import Annotated, ClassVar, TypeVar

import numpy as np

from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.tasks.measures.agreement import connected, in_earshot, rounds_by_calls, rounds_needed
from clean_swarm_env.tasks.measures.order import barycentre
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import TaskState, WorldStart
from clean_swarm_env.world.task import Task
from selforg.arrays import KEPT, Floats, Ints
from selforg.commands import Commands

EARSHOT = 3.0
"""Distance up to which a robot is heard [m], the range of the configurations."""
NETWORK_TRIES = 1000
"""Draws of places until the robots form one network."""
CENTER = 1
"""State of a robot that has elected itself the centre."""
V = TypeVar("V", bound=TaskState)


class Standing(Task[TaskSettings, V]):
    """Robots stand still, also those of the baseline."""

    def command_baseline(self, commands: Commands) -> None:
        """Stand still."""


@TASKS.register
class FindBarycenter(Standing[TaskState]):
    """The robot nearest to the middle of the team has to elect itself."""

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
    mission = {
        "world": {"ground": "open", "width": 25.0, "height": 25.0},
        "robots": {"count": 9},
        "time_limit": 5.0,
    }
    fewest = 2
    apart, start_side = 0.6, 10.0

    def result(self) -> dict[str, Floats]:
        """Return how far those who are elected are from the barycentre, and how many they are."""
        positions, ground = self.world.positions, self.world.ground
        away = ground.distances(barycentre(positions, ground)[:, None], positions)
        if self.world.by_baseline:  # the mean over all draws
            return {self.measures[0].name: away.mean(axis=1), self.measures[1].name: np.ones(len(away))}
        elected = self.world.decisions()[1] == CENTER
        count = elected.sum(axis=1)
        mean = (away * elected).sum(axis=1) / np.maximum(count, 1)
        error = np.where(count > 0, mean, away.max(axis=1))  # no robot elected: counts as the farthest one
        return {self.measures[0].name: error, self.measures[1].name: count.astype(np.float64)}


class MeasuredValues(TaskState):
    """The values of the robots, and when all knew the largest one."""

    values: Annotated[Floats, "R", KEPT]
    agreed: Annotated[Ints, "W", KEPT]  # rounds until all agreed; 0 as long as they do not
    lot: Annotated[Ints, "W", KEPT]  # rounds of the baseline


@TASKS.register
class MaxValue(Standing[MeasuredValues]):
    """Each robot has measured a value; all robots have to learn the largest one."""

    story = "20 robots on 9 m x 9 m, each heard 3 m far, agree on the largest of their values"
    measures: ClassVar[tuple[Measure, ...]] = (
        Measure("rounds to agreement", "-", "lower", 6.0, "13 m across at 3 m a round, and one for the way around"),
        Measure("rounds beyond the fewest possible", "-", "lower", 1.0, "word needs a round a hop", guard=True),
    )
    baseline = "everybody asks one neighbour a round, drawn by lot"
    mission = {
        "world": {"ground": "open", "width": 18.0, "height": 18.0},
        "robots": {"count": 20},
        "time_limit": 12.0,
    }
    fewest = 2

    def place(self, start: WorldStart) -> None:
        """Put robots so that they form one network, and give them values."""
        for _ in range(NETWORK_TRIES):
            places = start.poses[:, :2] if start.given else start.scattered(start.robots, 0.6, 9.0)
            hears = in_earshot(places[None], EARSHOT, start.ground)[0]
            if start.given or connected(hears):
                break
        else:
            raise ConfigurationError(f"robots.count: expected as many as form a network, got {start.robots}")
        start.put_robots(places)
        values = start.rng.uniform(0.0, 100.0, size=start.robots)
        self.state.values[start.rows] = values
        self.state.lot[start.world] = rounds_by_calls(hears, values, start.rng, int(self.world.limits[start.world]))

    def known(self) -> dict[str, Floats]:
        """Return the values."""
        return {"measured": self.state.values}

    def after_moving(self) -> None:
        """Note when all have agreed; in the first period robots send their own values only."""
        if self.world.by_baseline:
            return
        state, best = self.state, self._values.max(axis=1, keepdims=True)
        agreed = (self.world.decisions()[0] == best).all(axis=1)
        state.agreed[:] = np.where((state.agreed == 0) & agreed, self.world.ticks, state.agreed)

    @property
    def _values(self) -> Floats:
        return self.world.by_world(self.state.values)

    def result(self) -> dict[str, Floats]:
        """Return the rounds until all agreed, and how many more than possible; the last round if they never do."""
        limits = self.world.limits
        rounds = np.where(self.state.agreed > 0, self.state.agreed - 1, limits).astype(np.float64)
        if self.world.by_baseline:
            rounds = self.state.lot.astype(np.float64)
        hears = in_earshot(self.world.positions, EARSHOT, self.world.ground)
        fewest = [rounds_needed(h, int(v.argmax())) for h, v in zip(hears, self._values, strict=True)]
        return {self.measures[0].name: rounds, self.measures[1].name: rounds - np.array(fewest)}
