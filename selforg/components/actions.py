"""Actions: what robots do while a behaviour of their network runs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.components.memory import Knowledge
from selforg.components.sources import GoalSource, MovementSource, Source
from selforg.mechanisms.decision_base import DecisionMechanism
from selforg.mechanisms.depositing import DepositingMechanism
from selforg.mechanisms.spreading import SpreadGradient


@dataclass(frozen=True)
class Commands:
    """What the robots are told in one tick.

    Attributes:
        vectors: (N, D) [m/s] where to move and how fast; of a robot that turns, only the direction counts.
        commanded: (N,) whether there is a command.
        in_place: (N,) whether it is to turn without moving.

    """

    vectors: Floats
    commanded: Flags
    in_place: Flags

    @staticmethod
    def none(rows: int, dim: int) -> Commands:
        """Return N rows without a command."""
        return Commands(np.zeros((rows, dim)), np.zeros(rows, dtype=np.bool_), np.zeros(rows, dtype=np.bool_))


class Action(ABC):
    """Blueprint of what a behaviour does: `act` is called in each step for the rows in which it runs.

    Subclasses implement `_act`, name the `sources` they look at, and may leave something behind in `_leave`, called
    when all movements of the tick are known.
    """

    sources: Sequence[Source] = ()

    @final
    def act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        """Act in `rows` (K,), of which `started` were started in this step; movements go into `commands`."""
        if len(rows):
            self._act(now, rows, started, commands)

    @final
    def leave(self, now: float, rows: Ints) -> None:
        """Leave in the world what others shall find from the next tick on."""
        if len(rows):
            self._leave(now, rows)

    @abstractmethod
    def _act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        """Act in at least one row."""

    def _leave(self, now: float, rows: Ints) -> None:  # noqa: B027  (most actions leave nothing)
        """Leave something behind in at least one row."""


class Act(Action):
    """Calls a function of the host with the time and the rows in which the behaviour was started."""

    def __init__(self, when_started: Callable[[float, Ints], None]) -> None:
        self._call = when_started

    def _act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        if len(started):
            self._call(now, started)


class Move(Action):
    """The movement vector becomes the command; a depositing mechanism deposits."""

    def __init__(self, source: MovementSource) -> None:
        self.source = source
        self.sources = (source,)

    def _act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        command_movements(
            rows, self.source.vectors, self.source.active, commands.vectors, commands.commanded, commands.in_place
        )

    def _leave(self, now: float, rows: Ints) -> None:
        if isinstance(self.source.mechanism, DepositingMechanism):
            self.source.mechanism.deposit(now, rows)


@lean_kernel
def command_movements(
    rows: Ints, vectors: Floats, active: Flags, to_vectors: Floats, commanded: Flags, in_place: Flags
) -> None:
    """Let `rows` (K,) move by their `vectors` (N, D) where there is one, `active` (N,)."""
    for row in rows:
        for axis in range(vectors.shape[1]):
            to_vectors[row, axis] = vectors[row, axis]
        commanded[row] = active[row]
        in_place[row] = False


class Turn(Action):
    """Turn without moving: towards the goal, or where a mechanism would go."""

    def __init__(self, source: MovementSource | GoalSource) -> None:
        self.source = source
        self.sources = (source,)

    def _act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        source = self.source
        towards, there_is = (
            (source.vectors, source.active) if isinstance(source, MovementSource) else (source.offsets, source.present)
        )
        commands.vectors[rows] = towards[rows]
        commands.commanded[rows] = there_is[rows]
        commands.in_place[rows] = True


class Decide(Action):
    """Decide, keep it and spread it, in every step."""

    def __init__(self, mechanism: DecisionMechanism) -> None:
        self.mechanism = mechanism

    def _act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        """Nothing moves; what is decided is spread when all movements are known."""

    def _leave(self, now: float, rows: Ints) -> None:
        self.mechanism.spread(now, rows)


class DecideState(Decide):
    """Decide and spread; the state, as its number in the mechanism's `states`, becomes knowledge under a name."""

    def __init__(self, mechanism: DecisionMechanism, knowledge: Knowledge, name: str) -> None:
        super().__init__(mechanism)
        if knowledge.kinds.get(name) == "fact" and len(mechanism.states) > 2:
            raise ValueError(f"DecideState: {len(mechanism.states)} states do not fit into the fact {name!r}")
        knowledge.values(name)  # it must exist
        self.knowledge, self.name = knowledge, name

    def _leave(self, now: float, rows: Ints) -> None:
        decision = self.mechanism.spread(now, rows)
        self.knowledge.write(self.name, rows[decision.decided], decision.states[decision.decided])


class Spread(Action):
    """Spread a configured gradient from the own pose, in every step."""

    def __init__(self, mechanism: SpreadGradient) -> None:
        self.mechanism = mechanism

    def _act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        """Nothing moves; the gradient is spread when all movements are known."""

    def _leave(self, now: float, rows: Ints) -> None:
        self.mechanism.spread(now, rows)


class SetState(Action):
    """When the behaviour starts, the robot knows a value under a name."""

    def __init__(self, knowledge: Knowledge, name: str, value: float) -> None:
        knowledge.write(name, [], value)  # name and value must fit
        self.knowledge, self.name, self.value = knowledge, name, value

    def _act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        self.knowledge.write(self.name, started, self.value)
