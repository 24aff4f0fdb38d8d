"""A mechanism, a sensor, a strategy and a task; the folders beside this file have what names them."""

import numpy as np

from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.tasks.measures.order import nearest_neighbours
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import TaskState
from clean_swarm_env.world.task import Task
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Flags, Floats, Ints
from selforg.components import SENSORS, MovementSource, SensorComponent
from selforg.gradients.pair import Pair
from selforg.mechanisms import MECHANISMS, FormulaMechanism

NEAREST = "distance to the nearest neighbour"


@MECHANISMS.register
class KeepDistance(FormulaMechanism):
    """Push neighbours away that are nearer than 3 m."""

    @staticmethod
    def formula(pair: Pair) -> float:
        """Return the length along the offset [m]: towards the gradient if positive, away from it if negative."""
        return min(pair.distance - 3.0, 0.0)


@SENSORS.register
class Pushed(SensorComponent):
    """Whether a mechanism asks for more than `speed` [m/s]."""

    kind = "fact"

    def __init__(self, mechanism: MovementSource, speed: float = 0.01) -> None:
        self.source, self.speed = mechanism, speed
        self.sources = (mechanism,)

    def read(self, rows: Ints) -> Flags:
        """Return the readings (K,) of `rows` (K,)."""
        return np.hypot(*self.source.vectors[rows].T) > self.speed


@STRATEGIES.register
class Second(DecisionStrategy):
    """Take the option with the second highest score where it is possible, else the highest."""

    def _select(self, decisions: Decisions) -> Ints:
        scores = np.tile(self.problem.scores, (len(decisions.rows), 1))
        first = best(scores, decisions.allowed)
        others = decisions.allowed & (np.arange(self.options) != first[:, None])
        return np.where(others.any(axis=1), best(scores, others | ~others.any(axis=1)[:, None]), first)


@TASKS.register
class KeepApart(Task[TaskSettings, TaskState]):
    """The measure is the distance to the nearest neighbour."""

    story = "6 robots from a square of 3 m x 3 m part on a torus of 100 m2 within 60 s"
    measures = (Measure(NEAREST, "m", "higher", 2.0, "half of the 4.4 m on a hexagonal lattice"),)
    mission = {  # noqa: RUF012  (a table that nobody changes)
        "world": {"width": 10.0, "height": 10.0}, "robots": {"count": 6}, "time_limit": 60.0, "knowledge": "my_swarm",
    }  # fmt: skip
    fewest = 2
    apart, start_side = 0.6, 3.0

    def result(self) -> dict[str, Floats]:
        """Return the mean distance to the nearest neighbour."""
        return {NEAREST: nearest_neighbours(self.world.positions, self.world.ground).mean(axis=1)}
