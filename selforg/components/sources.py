"""Sources, each of which asks one mechanism or query once in a tick, for all sensors and actions that read it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Annotated

import numpy as np

from selforg.arrays import CLOCKED, KEPT, Flags, Floats, Ints
from selforg.commands import MOVED, Moved
from selforg.declared import make_arrays
from selforg.elementary import directions, exponentials, logarithms
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store.columns import GOAL_RADIUS, PAIR_DISTANCE, PAIR_DX, PAIR_GOAL_RADIUS
from selforg.mechanisms.base import MovementMechanism
from selforg.mechanisms.decisions.base import DecisionMechanism
from selforg.program import Rows, Step

EVERYTHING_IN_VIEW = Filter()
CLOCK_TOLERANCE = 1e-6
"""Tolerance of times, because sums of control periods are rounded [s]."""


class Source(ABC):
    """Base class of sources, which are asked once in a tick before sensors read; answers are valid until the next.

    parts: sources whose answers it reads, which are asked before it.
    """

    parts: Sequence[Source] = ()

    @abstractmethod
    def ask(self, now: float, rows: Ints) -> None:
        """Renew the answers for `rows` (K,), of which there is at least one, at `now` [s]."""

    def asking(self, stage: int, rows: Rows) -> list[Step]:
        """Return the steps of a program that do as `ask` does."""
        return [Step(stage, self.ask, rows)]


class MovementSource(Source):
    """Answers of a movement mechanism.

    hold: time for which an answer is kept before the mechanism is asked again [s].
    exponent: if not 0, above 1: that of the power law by which times from `hold` to `longest` [s] are drawn, one for
        each answer. With an `Exploration` this is a Lévy walk (Viswanathan et al. 1999, doi:10.1038/44831).
    moved: the record of `vectors` (N, D) [m/s], zero without a movement, and `active` (N,), whether there is one.
    """

    vectors: Annotated[Floats, "N D", KEPT]
    active: Annotated[Flags, "N", KEPT]
    _asked: Annotated[Floats, "N", CLOCKED]  # time of the last question [s]
    _holds: Annotated[Floats, "N", KEPT]  # times for which the answers are kept [s]

    def __init__(
        self, mechanism: MovementMechanism, hold: float = 0.0, exponent: float = 0.0, longest: float = np.inf
    ) -> None:
        if not hold >= 0.0:
            raise ValueError(f"MovementSource: hold must be at least 0, got {hold}")
        if exponent != 0.0 and not exponent > 1.0:
            raise ValueError(f"MovementSource: exponent must be 0 or above 1, got {exponent}")
        self.mechanism, self.hold, self.exponent, self.longest = mechanism, float(hold), exponent, longest
        make_arrays(self, N=mechanism.poses.rows, D=mechanism.poses.space.dim)
        self.moved = MOVED.pack(Moved(self.vectors, self.active))
        self._asked[:], self._holds[:] = -np.inf, self.hold
        self.parts = getattr(mechanism, "parts", ())

    def forget(self, rows: Ints) -> None:
        """Drop the kept answers of `rows` (K,), so that the next tick asks the mechanism."""
        self._asked[rows] = -np.inf

    def ask(self, now: float, rows: Ints) -> None:
        if self.hold > 0.0:
            rows = rows[~self.active[rows] | (now - self._asked[rows] > self._holds[rows] - CLOCK_TOLERANCE)]
            if not len(rows):
                return
            self._asked[rows] = now
            if self.exponent:
                drawn = directions(self.mechanism.directions.next_directions(rows)[:, :2])
                shares = 0.5 + drawn / (2.0 * np.pi)  # of a circle: random numbers from 0 to 1
                times = self.hold * exponentials(logarithms(shares) / (1.0 - self.exponent))
                self._holds[rows] = np.minimum(times, self.longest)
        self.mechanism.move_into(now, rows, self.vectors, self.active)

    def asking(self, stage: int, rows: Rows) -> list[Step]:
        held = self.hold > 0.0
        return super().asking(stage, rows) if held else self.mechanism.moving(stage, rows, self.moved)


class GoalSource(Source):
    """The gradient that a query chooses, by default the nearest attractive one.

    offsets: (N, D) [m] from the own centre to the centre of the goal; zero without a goal.
    clearance: (N,) [m] distance of the centres minus both goal radii; 0 without a goal.
    present: (N,) whether there is a goal.
    """

    offsets: Annotated[Floats, "N D", KEPT]
    clearance: Annotated[Floats, "N", KEPT]
    present: Annotated[Flags, "N", KEPT]

    def __init__(self, buffer: SoBuffer, rule: str = "nearest_attractive", look: Filter = EVERYTHING_IN_VIEW) -> None:
        self._queries, self._poses = Queries(buffer), buffer.poses
        self.rule, self.look = rule, look
        make_arrays(self, N=self._poses.rows, D=self._poses.space.dim)

    def ask(self, now: float, rows: Ints) -> None:
        pairs, found = self._queries.choose(self.rule, now, rows, self.look)
        clearance = pairs[:, PAIR_DISTANCE] - pairs[:, PAIR_GOAL_RADIUS] - self._poses.own[rows, 0, GOAL_RADIUS]
        self.offsets[rows] = pairs[:, PAIR_DX : PAIR_DX + self.offsets.shape[1]]
        self.clearance[rows] = np.where(found, clearance, 0.0)
        self.present[rows] = found


class DecisionSource(Source):
    """The decision that a mechanism would make now; only an action makes the mechanism keep and spread it.

    values: (N,) [-]; states: (N,) indices into the `states` of the mechanism.
    differs: (N,) whether value or state differ from those that the mechanism holds.
    """

    values: Annotated[Floats, "N", KEPT]
    states: Annotated[Ints, "N", KEPT]
    differs: Annotated[Flags, "N", KEPT]

    def __init__(self, mechanism: DecisionMechanism) -> None:
        self.mechanism = mechanism
        self.values = mechanism.values.copy()
        self.states = mechanism.state_codes.copy()
        self.differs = np.zeros(len(self.values), dtype=np.bool_)

    def ask(self, now: float, rows: Ints) -> None:
        decision = self.mechanism.decide(now, rows)
        self.values[rows], self.states[rows] = decision.values, decision.states
        held = (decision.values == self.mechanism.values[rows]) & (decision.states == self.mechanism.state_codes[rows])
        self.differs[rows] = ~held


class Surroundings:
    """Whatever rays from robots meet: nothing, unless a host says otherwise."""

    def rays(self, angles: Floats, reach: float, things: float) -> Callable[[Ints], Floats]:
        """Return what casts rays: for rows (P,) it returns how far each ray goes (P, K) [m], at most `reach` [m].

        angles: (K,) to the left of the robot's heading [rad]. things: radius as which things count that have none [m];
        0: rays meet walls and robots only.
        """
        return lambda rows: np.full((len(rows), len(angles)), reach)
