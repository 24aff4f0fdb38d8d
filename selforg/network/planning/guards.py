"""Conditions and actions of a planning problem in the form the search reads: bit masks and whole numbers.

A state is `(bits, numbers)`: bit i of `bits` is fact i, `numbers` a tuple of K ints in steps of 1e-9 of the unit.
Whole numbers make sums exact: two orders of the same actions always meet in the same state, and equal costs are ties.

Every bound on a number is one crossing point c, asked from above (x >= c) or from below (x < c). All four relations can
be written so, because no value lies between two neighbouring whole numbers.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from selforg.network.planning.problem import (
    AllOf,
    AnyOf,
    ChangeNumber,
    Expression,
    FactIs,
    Not,
    NumberIs,
    PlanningAction,
    SetFact,
)

STEPS_PER_UNIT = 1_000_000_000


class FactTest(NamedTuple):
    """Fact `slot` has the value `wanted`."""

    slot: int
    wanted: bool


class NumberTest(NamedTuple):
    """Number `slot` is at or above `crossing` (`above`) or below it (not `above`)."""

    slot: int
    crossing: int
    above: bool


Test: TypeAlias = FactTest | NumberTest


class Guard(NamedTuple):
    """A conjunction: facts by mask, bounds on numbers, and for each disjunction its alternatives."""

    mask: int
    want: int
    tests: tuple[NumberTest, ...]
    choices: "tuple[tuple[Guard, ...], ...]"


class GuardedAction(NamedTuple):
    """An action of the problem, allowed where `guard` holds.

    Afterwards bits = bits & keep | gain, and every (slot, change) of `changes` is added to the numbers.
    """

    action: int
    cost: int
    guard: Guard
    keep: int
    gain: int
    changes: tuple[tuple[int, int], ...]


@dataclass
class _Parts:
    """What a conjunction is being collected from."""

    facts: dict[int, bool] = field(default_factory=dict)
    tests: list[NumberTest] = field(default_factory=list)
    choices: list[tuple[Guard, ...]] = field(default_factory=list)


def in_steps(value: float) -> int:
    """Return a reading, bound, change or cost as a whole number of steps of 1e-9."""
    return round(value * STEPS_PER_UNIT)


def make_guard(expression: Expression, wanted: bool = True) -> Guard:
    """Return the guard that holds exactly where the expression has the truth value `wanted`."""
    parts = _Parts()
    _collect(expression, wanted, parts)
    mask = sum(1 << slot for slot in parts.facts)
    want = sum(1 << slot for slot, value in parts.facts.items() if value)
    return Guard(mask, want, tuple(dict.fromkeys(parts.tests)), tuple(parts.choices))


def _collect(expression: Expression, wanted: bool, parts: _Parts) -> None:
    match expression:
        case Not(part):
            _collect(part, not wanted, parts)
        case FactIs(fact, value):
            # A fact that has to be true and false never holds, as a disjunction without alternatives.
            if parts.facts.setdefault(fact, value is wanted) is not (value is wanted):
                parts.choices.append(())
        case NumberIs(number, relation, value):
            crossing = in_steps(value) + (relation in ("<=", ">"))
            parts.tests.append(NumberTest(number, crossing, (relation in (">=", ">")) is wanted))
        case AllOf(children) | AnyOf(children):
            if isinstance(expression, AllOf) is wanted or len(children) == 1:
                for child in children:
                    _collect(child, wanted, parts)
            else:
                parts.choices.append(tuple(make_guard(child, wanted) for child in children))


def guarded_action(index: int, action: PlanningAction) -> GuardedAction:
    """Return action number `index` of a problem in the form the search reads."""
    gain = sum(1 << e.fact for e in set(action.effects) if isinstance(e, SetFact) and e.value)
    lost = sum(1 << e.fact for e in set(action.effects) if isinstance(e, SetFact) and not e.value)
    changes: dict[int, int] = {}
    for effect in action.effects:
        if isinstance(effect, ChangeNumber):
            changes[effect.number] = changes.get(effect.number, 0) + in_steps(effect.change)
    moved = tuple((slot, change) for slot, change in changes.items() if change)
    return GuardedAction(index, in_steps(action.cost), make_guard(AllOf(action.preconditions)), ~lost, gain, moved)


def is_met(guard: Guard, bits: int, numbers: tuple[int, ...]) -> bool:
    """Say whether the guard holds in a state."""
    if bits & guard.mask != guard.want:
        return False
    for slot, crossing, above in guard.tests:
        if (numbers[slot] >= crossing) is not above:
            return False
    return all(any(is_met(option, bits, numbers) for option in options) for options in guard.choices)


def mandatory_tests(guard: Guard) -> tuple[Test, ...]:
    """Return the tests that hold wherever the guard does (those outside its disjunctions)."""
    slots = [slot for slot in range(guard.mask.bit_length()) if guard.mask >> slot & 1]
    facts = [FactTest(slot, bool(guard.want >> slot & 1)) for slot in slots]
    return (*facts, *guard.tests)


def all_tests(guard: Guard) -> Iterator[Test]:
    """Yield every test of a guard, those within its disjunctions included."""
    yield from mandatory_tests(guard)
    for options in guard.choices:
        for option in options:
            yield from all_tests(option)


def serves(step: GuardedAction, test: Test) -> bool:
    """Say whether the action can turn the test from false towards true."""
    if isinstance(test, FactTest):
        return bool(step.gain >> test.slot & 1) if test.wanted else not step.keep >> test.slot & 1
    return any(slot == test.slot and (change > 0) is test.above for slot, change in step.changes)
