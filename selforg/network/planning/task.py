"""A planning task: the part of a problem that matters for one set of goals, and lower bounds of the way to them.

Three things keep the search small without changing its answer.

*Relevance*: an action that turns no test that matters towards true is in no cheapest plan, and facts or numbers that no
test reads need no place in a state.
*Clamping*: a number that relevant actions only raise is the same anywhere above its highest bound, one that they only
lower the same anywhere below its lowest; counters then stop growing and "unsolvable" can be proved.
*Estimate*: every unsatisfied test that any plan must make true needs an action of its own; an action that serves n such
tests pays for 1/n of each. Starting from the goals, the preconditions that all servants of a needed test have in common
are needed too (the greedy-necessary landmarks of Hoffmann, Porteous and Sebastia 2004, doi:10.1613/jair.1492). The
estimate never exceeds the true cost and falls along an action by no more than its cost, so the first plan found is the
cheapest and no state is opened twice.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from math import gcd
from typing import NamedTuple

from selforg.network.planning.problem import (
    FactTest,
    Guard,
    NumberTest,
    PlanningAction,
    Test,
    all_tests,
    mandatory_tests,
    serves,
)

STEP_UNIT = 1 << 20
"""Share of one step in the estimate of the number of steps (steps are counted in these units)."""


class Landmark(NamedTuple):
    """A test that may be needed: what each servant costs at least, and what must have held before it.

    The test is `bits & mask == want` on a fact, or, where `mask` is 0, `bound` on a number.
    """

    mask: int
    want: int
    bound: NumberTest
    solvable: bool
    cost_share: int
    step_share: int
    stride: int
    before: tuple[int, ...]


class Scale(NamedTuple):
    """How one number is read: `low`/`high` clamp it (None: no clamp), `grid` is the step all changes share."""

    slot: int
    low: int | None
    high: int | None
    grid: int
    crossings: tuple[int, ...]


class PlanTask:
    """The relevant part of a problem for one conjunction of goals.

    Args:
        steps: all actions of the problem.
        goal: the guard the plan must end in.
        numbers: K, the number of numbers of a state.

    """

    def __init__(self, steps: Sequence[PlanningAction], goal: Guard, numbers: int) -> None:
        self.goal = goal
        relevant, tests = _relevant(steps, goal)
        self.fact_mask = sum(1 << slot for slot in {test.slot for test in tests if isinstance(test, FactTest)})
        read = {test.slot for test in tests if isinstance(test, NumberTest)}
        self.steps = tuple(
            step._replace(changes=tuple((slot, change) for slot, change in step.changes if slot in read))
            for step in relevant
        )
        self.scales = tuple(_scale(slot, self.steps, tests) for slot in sorted(read))
        self.landmarks, self.roots = _landmarks(self.steps, goal)
        self._numbers = numbers

    def start(self, bits: int, numbers: Sequence[int]) -> tuple[int, tuple[int, ...]]:
        """Return the state with everything irrelevant blanked and every number clamped."""
        values = [0] * self._numbers
        for slot, low, high, _, _ in self.scales:
            values[slot] = _clamped(numbers[slot], low, high)
        return bits & self.fact_mask, tuple(values)

    def after(self, step: PlanningAction, bits: int, numbers: tuple[int, ...]) -> tuple[int, tuple[int, ...]]:
        """Return the state an action leads to."""
        bits = (bits & step.keep | step.gain) & self.fact_mask
        if step.changes:
            values = list(numbers)
            for slot, change in step.changes:
                values[slot] += change
            for slot, low, high, _, _ in self.scales:
                values[slot] = _clamped(values[slot], low, high)
            numbers = tuple(values)
        return bits, numbers

    def estimate(self, bits: int, numbers: tuple[int, ...]) -> tuple[int, int] | None:
        """Return lower bounds for the cost and for the steps (in STEP_UNIT) still to go, None if there is no way."""
        cost = steps = 0
        landmarks = self.landmarks
        pending = list(self.roots)
        seen = set(pending)
        while pending:
            mask, want, bound, solvable, cost_share, step_share, stride, before = landmarks[pending.pop()]
            if mask:
                if bits & mask == want:
                    continue
                times = 1
            else:
                gap = _gap(bound, numbers)
                if gap <= 0:
                    continue
                times = -(-gap // stride)
            if not solvable:
                return None
            cost += cost_share * times
            steps += step_share * times
            for needed in before:
                if needed not in seen:
                    seen.add(needed)
                    pending.append(needed)
        return cost, steps


def _clamped(value: int, low: int | None, high: int | None) -> int:
    if high is not None and value > high:
        return high
    return low if low is not None and value < low else value


def _gap(bound: NumberTest, numbers: tuple[int, ...]) -> int:
    """Return by how much a number misses its bound; 0 or less where it holds."""
    slot, crossing, above = bound
    return crossing - numbers[slot] if above else numbers[slot] - crossing + 1


def _relevant(steps: Sequence[PlanningAction], goal: Guard) -> tuple[list[PlanningAction], list[Test]]:
    """Return the actions that can help the goal, directly or by helping each other, and all tests that matter."""
    tests = dict.fromkeys(all_tests(goal))
    chosen: set[int] = set()
    pending = list(tests)
    while pending:
        test = pending.pop()
        for position, step in enumerate(steps):
            if position not in chosen and serves(step, test):
                chosen.add(position)
                fresh = [other for other in all_tests(step.guard) if other not in tests]
                tests.update(dict.fromkeys(fresh))
                pending.extend(fresh)
    return [steps[position] for position in sorted(chosen)], list(tests)


def _scale(slot: int, steps: Sequence[PlanningAction], tests: Sequence[Test]) -> Scale:
    changes = [change for step in steps for number, change in step.changes if number == slot]
    crossings = sorted({test.crossing for test in tests if isinstance(test, NumberTest) and test.slot == slot})
    low = None if any(change > 0 for change in changes) else crossings[0] - 1
    high = None if any(change < 0 for change in changes) else crossings[-1]
    return Scale(slot, low, high, reduce(gcd, changes, 0), tuple(crossings))


def _landmarks(steps: Sequence[PlanningAction], goal: Guard) -> tuple[tuple[Landmark, ...], tuple[int, ...]]:
    """Return every test that may be needed and the positions of those the goal itself asks for."""
    tests = list(mandatory_tests(goal))
    roots = tuple(range(len(tests)))
    servants: list[list[PlanningAction]] = []
    before: list[tuple[int, ...]] = []
    while len(servants) < len(tests):
        serving = [step for step in steps if serves(step, tests[len(servants)])]
        servants.append(serving)
        common = _common(serving)
        tests.extend(test for test in common if test not in tests)
        before.append(tuple(tests.index(test) for test in common))
    served = {step.number: sum(serves(step, test) for test in tests) for step in steps}
    landmarks = [
        Landmark(
            *_comparison(test),
            bool(serving),
            min((step.cost // served[step.number] for step in serving), default=0),
            min((STEP_UNIT // served[step.number] for step in serving), default=0),
            max((_stride(step, test) for step in serving), default=1),
            needed,
        )
        for test, serving, needed in zip(tests, servants, before, strict=True)
    ]
    return tuple(landmarks), roots


def _comparison(test: Test) -> tuple[int, int, NumberTest]:
    """Return (mask, want, bound) of a landmark; the bound of a fact stands for nothing."""
    if isinstance(test, FactTest):
        return 1 << test.slot, test.wanted << test.slot, NumberTest(0, 0, True)
    return 0, 0, test


def _common(steps: Sequence[PlanningAction]) -> list[Test]:
    """Return the tests that every one of these actions asks for outside its disjunctions."""
    if not steps:
        return []
    return [
        test
        for test in mandatory_tests(steps[0].guard)
        if all(test in mandatory_tests(other.guard) for other in steps[1:])
    ]


def _stride(step: PlanningAction, test: Test) -> int:
    return 1 if isinstance(test, FactTest) else sum(abs(change) for slot, change in step.changes if slot == test.slot)


@dataclass
class _Reach:
    """What may hold: facts that may be true or false, numbers between `low` and `high` (None: without bound)."""

    true: int
    false: int
    low: list[int | None]
    high: list[int | None]


def reachable(steps: Sequence[PlanningAction], goal: Guard, bits: int, numbers: tuple[int, ...]) -> bool:
    """Return False if no sequence of `steps` can make `goal` hold from this state even if nothing is ever lost.

    Facts keep every value they ever had and numbers reach everything in the direction in which an action moves them
    (the delete relaxation of Bonet and Geffner 2001, doi:10.1016/S0004-3702(01)00108-4). The answer takes a few passes
    over the actions, however large the space of states is. Without this test the search would not end where no action
    serves a goal and another one raises a counter without bound.
    """
    reach = _Reach(bits, ~bits, list(numbers), list(numbers))
    waiting = list(steps)
    while not _may_hold(goal, reach):
        allowed = [step for step in waiting if _may_hold(step.guard, reach)]
        if not allowed:
            return False
        for step in allowed:
            _apply(step, reach)
        waiting = [step for step in waiting if step not in allowed]
    return True


def _may_hold(guard: Guard, reach: _Reach) -> bool:
    wants_true, wants_false = guard.mask & guard.want, guard.mask & ~guard.want
    if wants_true & ~reach.true or wants_false & ~reach.false:
        return False
    for slot, crossing, above in guard.tests:
        bound = reach.high[slot] if above else reach.low[slot]
        if bound is not None and (bound >= crossing) is not above:
            return False
    return all(any(_may_hold(option, reach) for option in options) for options in guard.choices)


def _apply(step: PlanningAction, reach: _Reach) -> None:
    reach.true |= step.gain
    reach.false |= ~step.keep
    for slot, change in step.changes:
        (reach.high if change > 0 else reach.low)[slot] = None
