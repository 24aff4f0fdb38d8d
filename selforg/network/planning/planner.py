"""The planner of a network, which makes plans for rows that need one; `planner_named` gives one by its name.

Plans hold no planner-independent behaviours.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.network.model.model import NetworkModel
from selforg.network.planning.memory import PlanMemory
from selforg.network.planning.pddl import EngineSearch, check_engine
from selforg.network.planning.problem import FactTest, NumberTest, PlanningProblem, all_of, all_tests
from selforg.network.planning.search import ForwardSearch, Plan, Search
from selforg.network.planning.spending import SpendingSearch, spent_numbers
from selforg.network.planning.task import PlanTask
from selforg.network.planning.translation import Translation


class Planner:
    """Plans for the planning problem of a model, goals by priority, for rows whose plan its `memory` does not hold.

    `make_search` makes what searches one problem: the built-in forward search, or an engine in its place (see
    `planner_named`).
    """

    def __init__(self, model: NetworkModel, make_search: Callable[[PlanningProblem], Search] = ForwardSearch) -> None:
        self.model = model
        self._make_search = make_search
        self._searches: dict[tuple[int, ...], SpendingSearch] = {}
        self._translation = Translation(model)
        self._coordinators = [b for b, behaviour in enumerate(model.behaviours) if behaviour.alternatives]
        self._task = self._make_task()
        self._spent = spent_numbers(self._task)
        self.memory = self._make_memory()

    def plan(self, readings: Floats, alternatives: Ints, goal_enabled: Ints) -> list[int] | None:
        """Return the behaviours of a plan in their order; None if no goal has a plan.

        Args:
            readings: (S,) of one row.
            alternatives: (B,) which of its alternatives each behaviour holds, -1: none.
            goal_enabled: (G,) 1 where a goal is on.

        """
        held = tuple(int(alternatives[b]) for b in self._coordinators)
        if held not in self._searches:
            self._searches[held] = SpendingSearch(self._problem(held), self._make_search, self._spent)
        search = self._searches[held]
        wanted = tuple(np.flatnonzero(goal_enabled).tolist())
        facts, numbers = readings[self._translation.facts] > 0.5, readings[self._translation.numbers]
        plan, is_of_class = search.plan(facts, numbers, wanted, self.memory.reach)
        if not is_of_class:
            self.memory.widen()
        outcome = plan.outcome
        if not isinstance(outcome, Plan):
            return None
        return [self.model.behaviour_index[search.problem.actions[action].name] for action in outcome.actions]

    def _problem(self, held: Sequence[int]) -> PlanningProblem:
        """Return the problem of a robot whose coordinators hold the alternatives `held`."""
        choice = dict(zip(self._coordinators, held, strict=True))
        actions = [
            self._translation.action(
                behaviour, [face for tag, face in behaviour.interfaces if tag < 0 or tag == choice.get(b)]
            )
            for b, behaviour in enumerate(self.model.behaviours)
            if not behaviour.planner_independent
        ]
        return self._translation.problem(actions)

    def _make_task(self) -> PlanTask:
        """Return the task of all goals with all that behaviours do in any combination of alternatives."""
        actions = []
        for behaviour in self.model.behaviours:
            if not behaviour.planner_independent:
                always, *others = behaviour.interfaces
                actions.append(self._translation.action(behaviour, [always[1]]))
                actions += [self._translation.action(behaviour, [always[1], other[1]]) for other in others]
        goal = all_of(goal.condition for goal in self._translation.goals)
        return PlanTask(self._translation.problem(actions).actions, goal, len(self._translation.numbers))

    def _make_memory(self) -> PlanMemory:
        """Return a memory whose keys tell apart whatever any combination of alternatives could depend on."""
        task = self._task
        tests = [*all_tests(task.goal), *(test for step in task.steps for test in all_tests(step.guard))]
        facts = sorted({test.slot for test in tests if isinstance(test, FactTest)})
        read = {test.slot for test in tests if isinstance(test, NumberTest)}
        return PlanMemory(
            [self._translation.facts[slot] for slot in facts],
            [(self._translation.numbers[scale.slot], scale) for scale in task.scales if scale.slot in read],
            self._coordinators,
            len(self.model.goals),
            {self._translation.numbers[number.slot]: number for number in self._spent},
        )


BUILT_IN, OFF = "built-in", "off"


def check_planner(name: str) -> None:
    """Refuse a name that `planner_named` would not know.

    Raises:
        ValueError: neither "built-in" nor "off", and no engine of that name is installed; lists what there is.
        ModuleNotFoundError: an engine is asked for, and the extra `planning` is not installed; says how to get it.

    """
    if name in (BUILT_IN, OFF):
        return
    try:
        check_engine(name)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"planner {name!r} is neither {BUILT_IN!r} nor {OFF!r}, and {error}") from error


def planner_named(model: NetworkModel, name: str) -> Planner | None:
    """Return the planner `name` for `model`: "built-in", "off" (none), or an engine such as "aries".

    Plans of an engine are remembered like those of the built-in search, so that the engine is asked seldom. An engine
    need not give the cheapest plan, nor the same one on every machine. A late answer counts as no plan.

    Raises:
        ValueError, ModuleNotFoundError: as `check_planner`.

    """
    check_planner(name)
    if name == OFF:
        return None
    return Planner(model) if name == BUILT_IN else Planner(model, partial(EngineSearch, engine=name))
