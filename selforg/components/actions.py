"""Actions, which robots carry out while a behaviour of their network runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, ClassVar, TypeAlias

from selforg.arrays import Ints
from selforg.commands import Commanded, Commands, Moved, open_commanded, open_moved
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle
from selforg.components.memory import Remembered
from selforg.components.sources import GoalSource, MovementSource, Source
from selforg.mechanisms.decisions.base import DecisionMechanism
from selforg.mechanisms.depositing import DepositingMechanism
from selforg.mechanisms.spreading import SpreadGradient
from selforg.mechanisms.steering.base import SteeringMechanism
from selforg.parameters import AtLeastZero, Finite, at_least
from selforg.plugins import Promises, are_numbers, check_answer, is_own
from selforg.program import ACT, LEAVE, STEER, Rows, Step
from selforg.registry import Registry

Call: TypeAlias = Callable[[float, Ints], None]
"""A function of the host, which gets the time [s] and the rows (K,)."""


class Action:
    """Base class of actions, whose methods are called in each step for the rows in which the behaviour runs.

    Subclasses implement one or more of the methods, and name the `sources` that they read. Documents can declare
    registered actions as they do a `SensorComponent`; for a parameter of type `Call` they give the name of a function
    of the host.
    """

    promises: ClassVar[Promises] = {
        "act": (
            "finite commands",
            lambda action, _, now, rows, started, commands: are_numbers(commands.vectors, *commands.vectors.shape),
            1,
            2,
        ),
        "steer": (
            "finite commands",
            lambda action, _, now, rows, commands: are_numbers(commands.vectors, *commands.vectors.shape),
            1,
        ),
    }
    sources: Sequence[Source] = ()

    example: ClassVar[Mapping[str, Any]] = {}
    """Arguments with which the contract tests build the class; the tests replace None."""

    def act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        """Act in `rows` (K,); the behaviour was started in this step in `started`; movements go into `commands`."""

    def steer(self, now: float, rows: Ints, commands: Commands) -> None:
        """Change the `commands` of `rows` (K,) at `now` [s], once all behaviours have acted."""

    def leave(self, now: float, rows: Ints) -> None:
        """Spread and deposit gradients in `rows` (K,) at `now` [s]; others perceive them from the next tick on."""

    def steps(self, rows: Rows, started: Rows, commands: Commands) -> list[Step]:
        """Return the steps of a program that do as the methods above do where the class has them."""
        each = {
            Action.act: Step(ACT, lambda now, acting: self.act(now, acting, started.now, commands), rows),
            Action.steer: Step(STEER, lambda now, acting: self.steer(now, acting, commands), rows),
            Action.leave: Step(LEAVE, self.leave, rows),
        }
        return [step for usual, step in each.items() if getattr(type(self), usual.__name__) is not usual]


ACTIONS: Registry[Action] = Registry("action", base=Action)


@ACTIONS.register
class Act(Action):
    """Call a function of the host with the time and the rows in which the behaviour was started."""

    def __init__(self, call: Call) -> None:
        self._call = call

    def act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        if len(started):
            self._call(now, started)


@ACTIONS.register
class Move(Action):
    """Command the movement vector of a mechanism; one that deposits, or a part of a sum that does, also deposits."""

    def __init__(self, mechanism: MovementSource) -> None:
        self.source = mechanism
        self.sources = (mechanism,)

    def steps(self, rows: Rows, started: Rows, commands: Commands) -> list[Step]:
        moving = Step(ACT, self.act, rows, command_movements, (self.source.moved, commands.packed))
        return [*super().steps(rows, started, commands), moving, *self._leaving(rows)]

    def _leaving(self, rows: Rows) -> Iterator[Step]:
        for one in (*self.source.parts, self.source):
            if isinstance(one, MovementSource) and isinstance(one.mechanism, DepositingMechanism):
                yield from one.mechanism.spreader.depositing(rows)


@lean_kernel
def command_movements(now: float, rows: Ints, moved: Handle[Moved], commands: Handle[Commanded]) -> int:
    """Command `rows` (K,) to make the movements of a mechanism; a step, see `selforg.program`."""
    m, given = open_commanded(commands), open_moved(moved)
    for row in rows:
        for axis in range(given.vectors.shape[1]):
            m.vectors[row, axis] = given.vectors[row, axis]
        m.commanded[row] = given.active[row]
        m.in_place[row] = False
    return 0


@ACTIONS.register
class Steer(Action):
    """Change by a mechanism what any behaviour of the robot commands, instead of commanding a movement."""

    def __init__(self, mechanism: SteeringMechanism) -> None:
        self.mechanism = mechanism

    def steer(self, now: float, rows: Ints, commands: Commands) -> None:
        self.mechanism.steer(now, rows, commands.packed.handle)
        if is_own(type(self.mechanism)):
            check_answer(self.mechanism, "steer", commands.vectors, commands.vectors.shape)

    def steps(self, rows: Rows, started: Rows, commands: Commands) -> list[Step]:
        kernel, *records = self.mechanism.steering(commands.packed) or (None,)
        if kernel is None or is_own(type(self.mechanism)):
            return super().steps(rows, started, commands)
        return [Step(STEER, lambda now, rows, _: self.steer(now, rows, commands), rows, kernel, tuple(records))]


@ACTIONS.register
class Turn(Action):
    """Turn without moving, towards a target or in the direction of a movement vector."""

    example: ClassVar[Mapping[str, Any]] = {"target": None}

    def __init__(self, mechanism: MovementSource | None = None, target: GoalSource | None = None) -> None:
        source = mechanism or target
        if source is None or (mechanism and target):
            raise ValueError("expected a mechanism or a target")
        self.source: MovementSource | GoalSource = source
        self.sources = (source,)

    def act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        source = self.source
        towards, there_is = (
            (source.vectors, source.active) if isinstance(source, MovementSource) else (source.offsets, source.present)
        )
        commands.vectors[rows] = towards[rows]
        commands.commanded[rows] = there_is[rows]
        commands.in_place[rows] = True


@ACTIONS.register
class Decide(Action):
    """Make, keep and spread a decision in every step."""

    def __init__(self, mechanism: DecisionMechanism) -> None:
        self.mechanism = mechanism

    def leave(self, now: float, rows: Ints) -> None:
        self.mechanism.spread(now, rows)


@ACTIONS.register
class DecideState(Decide):
    """Decide and spread, and remember the state under a name, as its index in the `states` of the mechanism."""

    def __init__(self, mechanism: DecisionMechanism, name: Remembered) -> None:
        super().__init__(mechanism)
        if name.kind == "fact" and len(mechanism.states) > 2:
            raise ValueError(f"DecideState: {len(mechanism.states)} states do not fit into the fact {name.name!r}")
        self._remembered = name

    def leave(self, now: float, rows: Ints) -> None:
        decision = self.mechanism.spread(now, rows)
        self._remembered.write(rows[decision.decided], decision.states[decision.decided])


@ACTIONS.register
class Spread(Action):
    """Spread a configured gradient at the own pose in every step."""

    def __init__(self, mechanism: SpreadGradient) -> None:
        self.mechanism = mechanism

    def leave(self, now: float, rows: Ints) -> None:
        self.mechanism.spread(now, rows)

    def steps(self, rows: Rows, started: Rows, commands: Commands) -> list[Step]:
        own = type(self).leave is not Spread.leave or is_own(type(self.mechanism))
        return super().steps(rows, started, commands) if own else self.mechanism.spreader.depositing(rows)


@ACTIONS.register
class SetState(Action):
    """Remember a value under a name when the behaviour starts."""

    example: ClassVar[Mapping[str, Any]] = {"value": True}

    def __init__(self, name: Remembered, value: bool | Finite) -> None:
        name.write([], value)  # an error if the value is of another kind
        self._remembered, self._value = name, value

    def act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        self._remembered.write(started, self._value)


@ACTIONS.register
class HandOver(Action):
    """Ask the host to put down cargo for others once it has come nearer to its goal, unless it is nearly there.

    Args:
        gained: way by which the goal has come nearer since the robot took the cargo, from the host [m].
        left: way to the goal, from the host [m].
        ask: what the host is asked by: the time `blind`, where cargo is to be put down [s].
        span: way from which it is put down [m]; 0: it never is.
        near: way to the goal up to which the robot carries on [m].
        blind: time for which the robot then looks for no other cargo [s].

    """

    example: ClassVar[Mapping[str, Any]] = {"span": 4.0, "near": 2.0, "blind": 10.0}

    def __init__(
        self,
        gained: Remembered,
        left: Remembered,
        ask: Remembered,
        *,
        span: AtLeastZero,
        near: AtLeastZero,
        blind: Finite,
    ) -> None:
        self._gained, self._left, self._ask = gained, left, ask
        self._span, self._near, self._blind = span, near, at_least(self, "blind", blind, 1e-6)

    def act(self, now: float, rows: Ints, started: Ints, commands: Commands) -> None:
        if self._span > 0.0:
            ends = (self._gained.values[rows] >= self._span) & (self._left.values[rows] > self._near)
            self._ask.values[rows[ends]] = self._blind
