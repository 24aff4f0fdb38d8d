"""Any engine of the unified-planning library in place of the built-in search, by name (extra `planning`).

An engine gets the problem in whole numbers, because several engines know no others. All changes of a number are whole
multiples of its grid g; with the reading x = k g + r, the remainder r never changes and k counts grid steps. A bound
x >= c is then k >= ceil((c - r) / g). Costs are counted in their own common step. Nothing is rounded: a plan solves one
problem exactly if it solves the other.

The library is imported when a function here is called, because it is optional.
"""

from functools import lru_cache, reduce
from importlib import import_module
from math import gcd
from typing import Any

import numpy as np
import numpy.typing as npt

from selforg.network.planning.problem import FactTest, Guard, PlanningAction, PlanningProblem, Test, mandatory_tests
from selforg.network.planning.search import Answer, ForwardSearch, Search, State, Unknown, Unsolvable

INSTALL = "pip install '.[planning]'"
FREE_GRID = 1 << 62
"""Grid of a number that nothing changes: so wide that only the truth of its bounds is left."""


@lru_cache(maxsize=1)
def environment() -> Any:  # noqa: ANN401  (the library is optional and untyped for us)
    """Return the library's global environment, which prints no credits.

    Raises:
        ModuleNotFoundError: the extra `planning` is not installed.

    """
    try:
        shortcuts = import_module("unified_planning.shortcuts")
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"planning engines and PDDL need unified-planning: {INSTALL}") from error
    shared = shortcuts.get_environment()
    shared.credits_stream = None
    return shared


def check_engine(engine: str) -> None:
    """Refuse a name of an engine that is not installed.

    Raises:
        ValueError: an engine that is not installed; lists those that are.
        ModuleNotFoundError: the extra `planning` is not installed.

    """
    known = environment().factory.engines
    if engine not in known:
        raise ValueError(f"unknown planning engine {engine!r} (installed: {', '.join(sorted(known))})")


class EngineSearch(Search):
    """Asks an engine for plans; their cost and order are as good as the engine makes them.

    Args:
        problem: facts, numbers, actions and goals.
        engine: name of an engine that is installed, such as "aries".
        timeout: time after which the answer is `Unknown` [s]; None waits.

    Raises:
        ValueError: an engine that is not installed; lists those that are.
        ModuleNotFoundError: the extra `planning` is not installed.

    """

    def __init__(self, problem: PlanningProblem, engine: str, timeout: float | None = 10.0) -> None:
        super().__init__(problem)
        check_engine(engine)
        self.engine = engine
        self.timeout = timeout

    def plan_from(self, state: State, goals: tuple[int, ...]) -> Answer:
        """Return the engine's answer for a state that `read_state` gave."""
        task = to_unified(self, state, goals)
        with environment().factory.OneshotPlanner(name=self.engine) as planner:
            if not planner.supports(task.kind):
                raise ValueError(f"engine {self.engine!r} cannot read this problem: {task.kind.features}")
            return self._outcome(planner.solve(task, timeout=self.timeout))

    def _outcome(self, result: Any) -> Answer:  # noqa: ANN401  (optional library)
        if result.plan is not None:
            indices = {action.name: index for index, action in enumerate(self.problem.actions)}
            return self.found(tuple(indices[step.action.name] for step in result.plan.actions))
        if result.status.name == "UNSOLVABLE_PROVEN":
            return Unsolvable()
        if result.status.name in ("UNSOLVABLE_INCOMPLETELY", "TIMEOUT", "MEMOUT"):
            return Unknown(0)
        raise RuntimeError(f"engine {self.engine!r} failed with {result.status.name}")


def to_unified(search: Search, state: State, goals: tuple[int, ...]) -> Any:  # noqa: ANN401
    """Return a `unified_planning.model.Problem`: this start, these goals together, the sum of costs minimised."""
    return _Translator(search.problem, state).problem(search.goal_condition(goals))


def write_pddl(
    problem: PlanningProblem, facts: npt.NDArray[np.bool_], numbers: npt.NDArray[np.float64], goals: tuple[int, ...]
) -> tuple[str, str]:
    """Return the texts of a PDDL domain and problem, for facts (F,) and numbers (K,) at the start and goals by index.

    Numbers count grid steps. Names lose what PDDL does not allow in names; the order of actions stays.
    """
    search = ForwardSearch(problem)
    task = to_unified(search, search.read_state(facts, numbers), goals)
    writer = import_module("unified_planning.io").PDDLWriter(task)
    return writer.get_domain(), writer.get_problem()


class _Translator:
    """Builds the library's problem out of ours, in whole numbers."""

    def __init__(self, problem: PlanningProblem, state: State) -> None:
        self.env = environment()
        self.make = self.env.expression_manager
        self.model = import_module("unified_planning.model")
        self.steps, self.state = problem.actions, state
        types = self.env.type_manager
        self.facts = [self.model.Fluent(name, types.BoolType(), environment=self.env) for name in problem.facts]
        self.numbers = [self.model.Fluent(name, types.IntType(), environment=self.env) for name in problem.numbers]
        self.grids = [self._grid(number) for number in range(len(self.numbers))]

    def problem(self, goal: Guard) -> Any:  # noqa: ANN401
        target = self.model.Problem("clean-swarm", self.env)
        bits, readings = self.state
        for slot, fluent in enumerate(self.facts):
            target.add_fluent(fluent, default_initial_value=bool(bits >> slot & 1))
        for fluent, reading, grid in zip(self.numbers, readings, self.grids, strict=True):
            target.add_fluent(fluent, default_initial_value=reading // grid)
        actions = [self.action(step) for step in self.steps]
        target.add_actions(actions)
        target.add_goal(self.condition(goal))
        unit = reduce(gcd, (step.cost for step in self.steps), 0) or 1
        costs = {action: self.make.Int(step.cost // unit) for action, step in zip(actions, self.steps, strict=True)}
        metrics = import_module("unified_planning.model.metrics")
        target.add_quality_metric(metrics.MinimizeActionCosts(costs, environment=self.env))
        return target

    def action(self, step: PlanningAction) -> Any:  # noqa: ANN401
        target = self.model.InstantaneousAction(step.name, _env=self.env)
        target.add_precondition(self.condition(step.guard))
        for slot, fluent in enumerate(self.facts):
            gained, kept = step.gain >> slot & 1, step.keep >> slot & 1
            if gained or not kept:
                target.add_effect(fluent, bool(gained))
        for slot, change in step.changes:
            add = target.add_increase_effect if change > 0 else target.add_decrease_effect
            add(self.numbers[slot], abs(change) // self.grids[slot])
        return target

    def condition(self, guard: Guard) -> Any:  # noqa: ANN401
        choices = [self.make.Or([self.condition(option) for option in options]) for options in guard.choices]
        return self.make.And([*map(self._test, mandatory_tests(guard)), *choices])

    def _test(self, test: Test) -> Any:  # noqa: ANN401
        if isinstance(test, FactTest):
            reading = self.make.FluentExp(self.facts[test.slot])
            return reading if test.wanted else self.make.Not(reading)
        grid = self.grids[test.slot]
        bound = -((self.state[1][test.slot] % grid - test.crossing) // grid)
        compare = self.make.GE if test.above else self.make.LT
        return compare(self.make.FluentExp(self.numbers[test.slot]), self.make.Int(bound))

    def _grid(self, number: int) -> int:
        """Return the largest step that all changes of a number are multiples of."""
        changes = [change for step in self.steps for slot, change in step.changes if slot == number]
        return reduce(gcd, changes, 0) or FREE_GRID
