"""The built-in planner: the cheapest plan by forward search, or the proof that there is none.

A* over the states of a `PlanTask`. Of all plans the answer is the one with the lowest cost, of those the one with the
fewest steps, of those the first in registration order: compared action by action, the plan whose first different action
was registered earlier. The answer therefore depends on the problem and the state only, and a robot whose behaviours are
registered as task chain, patrol, avoidance gets them in this order wherever costs leave a choice.
"""

import heapq
import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TypeAlias, final

import numpy as np
import numpy.typing as npt

from selforg.network.planning.problem import STEPS_PER_UNIT, Guard, PlanningProblem, all_of, in_steps, is_met
from selforg.network.planning.task import STEP_UNIT, PlanTask, reachable
from selforg.parameters import at_least


@dataclass(frozen=True)
class Plan:
    """Indices of the actions in order, and the sum of their costs; an empty plan says that the goals hold already."""

    actions: tuple[int, ...]
    cost: float


@dataclass(frozen=True)
class Unsolvable:
    """Proved: no sequence of actions reaches the goals together."""


@dataclass(frozen=True)
class Unknown:
    """The search opened `nodes` states without an answer and gave up."""

    nodes: int


Answer: TypeAlias = Plan | Unsolvable | Unknown
State: TypeAlias = tuple[int, tuple[int, ...]]


class Search(ABC):
    """The interface of planners for one problem: the built-in search, or an engine in its place.

    `plan` and `read_state` are the same for all; an implementation answers in `plan_from`.
    """

    def __init__(self, problem: PlanningProblem) -> None:
        self.problem = problem

    @final
    def plan(self, facts: npt.NDArray[np.bool_], numbers: npt.NDArray[np.float64], goals: Sequence[int]) -> Answer:
        """Return the best plan that makes all of `goals` hold together.

        Args:
            facts: (F,) bool, the facts as they are now.
            numbers: (K,) float, the readings as they are now, finite.
            goals: indices of goals of the problem; none at all is satisfied at once.

        """
        return self.plan_from(self.read_state(facts, numbers), tuple(goals))

    @final
    def read_state(self, facts: npt.NDArray[np.bool_], numbers: npt.NDArray[np.float64]) -> State:
        """Return facts (F,) bool and numbers (K,) float as the state the search works on.

        Raises:
            ValueError: a wrong shape or a reading that is not finite.

        """
        if facts.shape != (len(self.problem.facts),) or numbers.shape != (len(self.problem.numbers),):
            expected = f"facts ({len(self.problem.facts)},) and numbers ({len(self.problem.numbers)},)"
            raise ValueError(f"expected {expected}, got {facts.shape} and {numbers.shape}")
        bits = int.from_bytes(np.packbits(facts, bitorder="little").tobytes(), "little")
        values = numbers.tolist()
        for name, value in zip(self.problem.numbers, values, strict=True):
            if not math.isfinite(value):
                raise ValueError(f"number '{name}' must be finite, got {value}")
        return bits, tuple([in_steps(value) for value in values])

    @abstractmethod
    def plan_from(self, state: State, goals: tuple[int, ...]) -> Answer:
        """Return the best plan from a state that `read_state` gave."""

    def goal_condition(self, goals: tuple[int, ...]) -> Guard:
        """Return the conjunction of goals given by their indices."""
        for goal in goals:
            if not 0 <= goal < len(self.problem.goals):
                raise ValueError(f"goal index must be in 0..{len(self.problem.goals) - 1}, got {goal}")
        return all_of(self.problem.goals[goal].condition for goal in goals)

    def found(self, actions: tuple[int, ...]) -> Plan:
        """Return the plan of these actions with its cost."""
        return Plan(actions, sum(self.problem.actions[index].cost for index in actions) / STEPS_PER_UNIT)


class ForwardSearch(Search):
    """Cost-optimal forward search over one planning problem.

    Args:
        problem: facts, numbers, actions and goals.
        node_limit: states a single search may open before it answers `Unknown`.

    >>> from selforg.network.planning.problem import PlanningGoal, fact_is, planning_action
    >>> pick = planning_action("Pick", [fact_is(0)], [(1, True)])
    >>> problem = PlanningProblem(("at", "carrying"), (), (pick,), (PlanningGoal("Carry", fact_is(1)),))
    >>> ForwardSearch(problem).plan(np.array([True, False]), np.zeros(0), [0])
    Plan(actions=(0,), cost=1.0)

    """

    def __init__(self, problem: PlanningProblem, node_limit: int = 20_000) -> None:
        at_least(self, "node_limit", node_limit, 1)
        super().__init__(problem)
        self.node_limit = node_limit
        self._tasks: dict[tuple[int, ...], PlanTask] = {}

    def plan_from(self, state: State, goals: tuple[int, ...]) -> Answer:
        """Return the best plan from a state that `read_state` gave."""
        task = self._task(goals)
        return self._search(task, task.start(*state))

    def _task(self, goals: tuple[int, ...]) -> PlanTask:
        task = self._tasks.get(goals)
        if task is None:
            goal = self.goal_condition(goals)
            task = self._tasks[goals] = PlanTask(self.problem.actions, goal, len(self.problem.numbers))
        return task

    def _search(self, task: PlanTask, start: State) -> Answer:
        """Open states in order of (cost, steps) reached plus estimated, ties by the sequence of actions."""
        if is_met(task.goal, *start):
            return Plan((), 0.0)
        if not reachable(task.steps, task.goal, *start):
            return Unsolvable()
        frontier: list[tuple[int, int, tuple[int, ...], int, State]] = [(0, 0, (), 0, start)]
        best: dict[State, tuple[int, int, tuple[int, ...]]] = {}
        opened: set[State] = set()
        while frontier:
            _, _, sequence, cost, state = heapq.heappop(frontier)
            if state in opened:
                continue
            if is_met(task.goal, *state):
                return self.found(sequence)
            if len(opened) == self.node_limit:
                return Unknown(self.node_limit)
            opened.add(state)
            for step in task.steps:
                if not is_met(step.guard, *state):
                    continue
                following = task.after(step, *state)
                reached = (cost + step.cost, len(sequence) + 1, (*sequence, step.number))
                if following in opened or best.get(following, reached) < reached:
                    continue
                best[following] = reached
                ahead = task.estimate(*following)
                if ahead is not None:
                    promise = (reached[0] + ahead[0], reached[1] * STEP_UNIT + ahead[1])
                    heapq.heappush(frontier, (*promise, reached[2], reached[0], following))
        return Unsolvable()


MOST_GOALS_COMBINED = 10
"""Up to this number of goals, all subsets are tried (2^10 searches at most); of more, goals are given up one by one."""


@dataclass(frozen=True)
class PriorityPlan:
    """The outcome for the best set of goals that has a plan; `goals` are those that the plan reaches.

    Without a plan for any goal `outcome` is `Unsolvable`, or `Unknown` if a search gave up; `goals` is then empty.
    `proved`: every set that was tried in vain is proved unsolvable.
    """

    outcome: Answer
    goals: tuple[int, ...]
    proved: bool = True


def plan_by_priority(search: Search, state: State, goals: tuple[int, ...]) -> PriorityPlan:
    """Return a plan for all goals together, else for the best set of goals that has one.

    After the whole set, sets are tried by falling sum of priorities, then falling size, then in the order in which the
    goals are registered: the goals with the lowest priorities are given up first. Goals that hold already cost nothing
    by themselves and stay in the set, so that a plan does not destroy them. A set that contains a set already proved
    unsolvable is not searched.

    Args:
        search: the planner with its problem.
        state: facts and numbers as they are now, from `read_state`.
        goals: indices of the goals wanted now, rising.

    """
    unsolvable: list[set[int]] = []
    failure: Answer = Unsolvable()
    for chosen in goal_sets(goals, [search.problem.goals[goal].priority for goal in goals]):
        if any(known.issubset(chosen) for known in unsolvable):
            continue
        outcome = search.plan_from(state, chosen)
        if isinstance(outcome, Plan):
            return PriorityPlan(outcome, chosen, isinstance(failure, Unsolvable))
        if isinstance(outcome, Unsolvable):
            unsolvable.append(set(chosen))
        else:
            failure = outcome
    return PriorityPlan(failure, (), isinstance(failure, Unsolvable))


def goal_sets(goals: tuple[int, ...], priorities: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """Yield sets of goals in the order in which they are tried, the whole set first, each without repetition."""
    yield goals
    importance = dict(zip(goals, priorities, strict=True))
    if len(goals) > MOST_GOALS_COMBINED:
        kept = sorted(goals, key=lambda goal: (-importance[goal], goal))
        for size in range(len(kept) - 1, 0, -1):
            yield tuple(sorted(kept[:size]))
        return
    sets = [chosen for size in range(1, len(goals)) for chosen in combinations(goals, size)]
    yield from sorted(sets, key=lambda chosen: (-sum(importance[goal] for goal in chosen), -len(chosen), chosen))
