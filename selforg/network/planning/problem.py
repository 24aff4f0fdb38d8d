"""A planning problem as the search reads it: facts and numbers, actions that change them, goals over them.

A problem is frozen data and knows no behaviour network: behaviours become actions (effects on facts set them,
effects on numbers change them), goals become conditions. The state it is asked for is two arrays, `facts` (F,) bool
and `numbers` (K,) float in the order of the names given here.

Inside, a state is `(bits, numbers)`: bit i of `bits` is fact i, `numbers` a tuple of K ints in steps of 1e-9 of the
unit. Whole numbers make sums exact: two orders of the same actions always meet in the same state, and equal costs are
ties. Conditions are made by `fact_is`, `number_is`, `all_of` and `any_of`.

Every bound on a number is one crossing point c, asked from above (x >= c) or from below (x < c). All four relations can
be written so, because no value lies between two neighbouring whole numbers.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

STEPS_PER_UNIT = 1_000_000_000

Relation: TypeAlias = Literal[">=", "<=", ">", "<"]


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


Effect: TypeAlias = tuple[int, bool | float]
"""A fact and the value it gets, or a number and its change, in the unit of its sensor."""


class PlanningAction(NamedTuple):
    """One step a plan may take, allowed where `guard` holds; see `planning_action`.

    Afterwards bits = bits & keep | gain, and every (slot, change) of `changes` is added to the numbers.
    """

    name: str
    guard: Guard
    keep: int
    gain: int
    changes: tuple[tuple[int, int], ...]
    cost: int
    number: int = -1
    """Its place in the problem."""


@dataclass(frozen=True)
class PlanningGoal:
    """A condition that should hold when the plan ends; a larger `priority` is given up later."""

    name: str
    condition: Guard
    priority: int = 0


@dataclass(frozen=True)
class PlanningProblem:
    """Names of the facts (F) and numbers (K), the actions (B) and goals (G) over them; each name once in its kind."""

    facts: tuple[str, ...]
    numbers: tuple[str, ...]
    actions: tuple[PlanningAction, ...]
    goals: tuple[PlanningGoal, ...]

    def __post_init__(self) -> None:
        """Give every action its place."""
        object.__setattr__(self, "actions", tuple(a._replace(number=k) for k, a in enumerate(self.actions)))


def in_steps(value: float) -> int:
    """Return a reading, bound, change or cost as a whole number of steps of 1e-9."""
    return round(value * STEPS_PER_UNIT)


def fact_is(fact: int, wanted: bool = True) -> Guard:
    """Return the condition that a fact has the value `wanted`."""
    return Guard(1 << fact, wanted << fact, (), ())


def number_is(number: int, relation: Relation, value: float) -> Guard:
    """Return the condition that a number stands in `relation` to `value`, in the unit of its sensor."""
    crossing = in_steps(value) + (relation in ("<=", ">"))
    return Guard(0, 0, (NumberTest(number, crossing, relation in (">=", ">")),), ())


def all_of(parts: Iterable[Guard]) -> Guard:
    """Return the condition that every part holds; without parts it always does."""
    mask = want = 0
    tests: dict[NumberTest, None] = {}
    choices: list[tuple[Guard, ...]] = []
    for part in parts:
        if (part.want ^ want) & part.mask & mask:
            choices.append(())  # a fact that has to be true and false: a disjunction without alternatives never holds
        want |= part.want & ~mask
        mask |= part.mask
        tests |= dict.fromkeys(part.tests)
        choices += part.choices
    return Guard(mask, want, tuple(tests), tuple(choices))


def any_of(parts: Iterable[Guard]) -> Guard:
    """Return the condition that at least one part holds; without parts it never does."""
    options = tuple(parts)
    return options[0] if len(options) == 1 else Guard(0, 0, (), (options,))


def planning_action(
    name: str, preconditions: Iterable[Guard], effects: Iterable[Effect], cost: float = 1.0
) -> PlanningAction:
    """Return an action that is allowed where all preconditions hold; all effects happen at once; `cost` >= 0."""
    gain = lost = 0
    changes: dict[int, int] = {}
    for slot, value in effects:
        if isinstance(value, bool):
            gain |= value << slot
            lost |= (not value) << slot
        else:
            changes[slot] = changes.get(slot, 0) + in_steps(value)
    moved = tuple((slot, change) for slot, change in changes.items() if change)
    return PlanningAction(name, all_of(preconditions), ~lost, gain, moved, in_steps(cost))


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


def serves(step: PlanningAction, test: Test) -> bool:
    """Say whether the action can turn the test from false towards true."""
    if isinstance(test, FactTest):
        return bool(step.gain >> test.slot & 1) if test.wanted else not step.keep >> test.slot & 1
    return any(slot == test.slot and (change > 0) is test.above for slot, change in step.changes)
