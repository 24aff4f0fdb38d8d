"""Sources, each of which asks one mechanism or query once in a tick, for all sensors and actions that read it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import CLOCKED, KEPT, READ, SCRATCH, Flags, Floats, Ints, derived
from selforg.commands import Moved
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Packed, Written, opening
from selforg.declared import make_arrays
from selforg.elementary import direction, exponential, logarithm
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.queries import Filter, Queries
from selforg.mechanisms.base import MovementMechanism
from selforg.mechanisms.decisions.base import DecisionMechanism
from selforg.parameters import at_least
from selforg.program import SENSE, Program, Rows, Step
from selforg.randomness import next_direction

EVERYTHING_IN_VIEW = Filter()
CLOCK_TOLERANCE = 1e-6
"""Tolerance of times, because sums of control periods are rounded [s]."""


class Answers(NamedTuple):
    """Answers to one question of all rows, as sensors read them."""

    there: Annotated[Flags, "R", READ]  # whether there is an answer
    values: Annotated[Floats, "R", READ]


open_answers = opening(Answers)


class Source(ABC):
    """Base class of sources, which are asked once in a tick before sensors read; answers are valid until the next.

    parts: sources whose answers it reads, which are asked before it.
    """

    parts: Sequence[Source] = ()

    @abstractmethod
    def asking(self, stage: int, rows: Rows) -> list[Step]:
        """Return the steps of a program that renew the answers for `rows`."""

    def ask(self, now: float, rows: Ints) -> None:
        """Renew the answers for `rows` (K,) at `now` [s]."""
        Program(lambda: self.asking(SENSE, Rows.of(rows))).run(now)


class KeptAnswers(NamedTuple):
    """For how long the answers of a `MovementSource` are kept, and which rows are asked again."""

    hold: float  # [s]; this and the next fields: see `MovementSource`
    exponent: float
    longest: float  # [s]
    active: Annotated[Flags, "R", READ]
    asked: Annotated[Floats, "R", CLOCKED]  # time of the last question [s]
    holds: Annotated[Floats, "R", KEPT]  # times for which the answers are kept [s]
    directions: Annotated[Floats, "R BLOCK 3", READ]  # unit vectors drawn ahead
    cursor: Annotated[Ints, "R", KEPT]  # next direction of each row
    low: Annotated[Flags, "1", derived(True)]  # set when a row has used half of its directions
    listed: Annotated[Ints, "R", SCRATCH]  # rows that are asked again, the first `length`
    length: Annotated[Ints, "1", SCRATCH]


open_kept_answers = opening(KeptAnswers)


@lean_kernel
def list_renewed(now: float, rows: Ints, keeping: Written[KeptAnswers]) -> int:
    """List those of `rows` (K,) whose answers are no longer kept; a step, see `selforg.program`.

    If random directions have to be drawn first, no row is listed, and the result is 1.
    """
    k = open_kept_answers(keeping)
    k.length[0] = 0
    if k.exponent != 0.0 and k.low[0] and len(rows) > 0:
        return 1
    for row in rows:
        if k.active[row] and now - k.asked[row] <= k.holds[row] - CLOCK_TOLERANCE:
            continue
        k.asked[row] = now
        k.listed[k.length[0]] = row
        k.length[0] += 1
        if k.exponent != 0.0:
            x, y, _ = next_direction(k.directions, k.cursor, k.low, row)
            share = 0.5 + direction(y, x) / (2.0 * np.pi)  # of a circle: a random number from 0 to 1
            time = k.hold * exponential(logarithm(share) / (1.0 - k.exponent))
            k.holds[row] = min(time, k.longest)
    return 0


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
        if exponent != 0.0 and not exponent > 1.0:
            raise ValueError(f"MovementSource: exponent must be 0 or above 1, got {exponent}")
        self.mechanism, self.hold = mechanism, at_least(self, "hold", hold, 0.0)
        make_arrays(self, N=mechanism.poses.rows, D=mechanism.poses.space.dim)
        self.moved = Packed(Moved(self.vectors, self.active))
        self._asked[:], self._holds[:] = -np.inf, self.hold
        stream, listed = mechanism.directions, Rows.of(np.zeros(len(self.active), dtype=np.int64))
        drawn = stream.vectors, stream.cursor, stream.low
        times = self.hold, float(exponent), float(longest), self.active, self._asked, self._holds
        self._keeping = Packed(KeptAnswers(*times, *drawn, *listed))
        self.parts = getattr(mechanism, "parts", ())

    def forget(self, rows: Ints) -> None:
        """Drop the kept answers of `rows` (K,), so that the next tick asks the mechanism."""
        self._asked[rows] = -np.inf

    def asking(self, stage: int, rows: Rows) -> list[Step]:
        if self.hold == 0.0:
            return self.mechanism.moving(stage, rows, self.moved)

        def draw(now: float, rows: Ints, _: int) -> None:
            self.mechanism.directions.refill()
            list_renewed(now, rows, self._keeping.handle)

        renewed = Rows(*self._keeping.record[-2:])
        listing = Step(stage, draw, rows, list_renewed, (self._keeping,), always=True)
        return [listing, *self.mechanism.moving(stage, renewed, self.moved)]


class GoalSource(Source):
    """The gradient that a query chooses, by default the nearest attractive one.

    offsets: (N, D) [m] from the own centre to the centre of the goal; zero without a goal.
    clearance: (N,) [m] distance of the centres minus both goal radii; 0 without a goal.
    present: (N,) whether there is a goal.
    answers: the record of clearances where there is a goal.
    """

    offsets: Annotated[Floats, "N D", KEPT]
    clearance: Annotated[Floats, "N", KEPT]
    present: Annotated[Flags, "N", KEPT]

    def __init__(self, buffer: SoBuffer, rule: str = "nearest_attractive", look: Filter = EVERYTHING_IN_VIEW) -> None:
        self._queries, self._asks = Queries(buffer), (rule, look)
        make_arrays(self, N=buffer.poses.rows, D=buffer.poses.space.dim)
        self.answers = Packed(Answers(self.present, self.clearance))

    def asking(self, stage: int, rows: Rows) -> list[Step]:
        return [self._queries.choosing(stage, rows, *self._asks, (self.offsets, self.clearance, self.present))]


class DecisionSource(Source):
    """The decision that a mechanism would make now; only an action makes the mechanism keep and spread it.

    values: (N,) [-]; states: (N,) indices into the `states` of the mechanism.
    differs: (N,) whether value or state differ from those that the mechanism holds.
    answers, changes: records of the values: of all, and where the decision differs.
    """

    values: Annotated[Floats, "N", KEPT]
    states: Annotated[Ints, "N", KEPT]
    differs: Annotated[Flags, "N", KEPT]

    def __init__(self, mechanism: DecisionMechanism) -> None:
        self.mechanism = mechanism
        self.values = mechanism.values.copy()
        self.states = mechanism.state_codes.copy()
        self.differs = np.zeros(len(self.values), dtype=np.bool_)
        self.answers = Packed(Answers(np.ones(len(self.values), dtype=np.bool_), self.values))
        self.changes = Packed(Answers(self.differs, self.values))

    def asking(self, stage: int, rows: Rows) -> list[Step]:
        return [Step(stage, self._decide, rows)]

    def _decide(self, now: float, rows: Ints) -> None:
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
