"""Planning problems to and from the unified-planning library and, through it, PDDL (extra `planning`).

The library is imported when a function here is called, because it is optional. Every constant becomes an exact fraction
in steps of 1e-9, so that no rounding decides between two plans; PDDL text keeps ten significant digits.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from selforg.network.planning.guards import STEPS_PER_UNIT, in_steps
from selforg.network.planning.problem import (
    AllOf,
    AnyOf,
    Expression,
    FactIs,
    Not,
    NumberIs,
    PlanningProblem,
    SetFact,
    constants,
)

INSTALL = "pip install 'clean-swarm[planning]'"


@lru_cache(maxsize=1)
def environment() -> Any:  # noqa: ANN401  (the library is optional and untyped for us)
    """Return the library's global environment, which prints no credits; its PDDL reader works in no other one.

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


def to_unified(
    problem: PlanningProblem, facts: npt.NDArray[np.bool_], numbers: npt.NDArray[np.float64], goals: Sequence[int]
) -> Any:  # noqa: ANN401
    """Return a `unified_planning.model.Problem`: this start, these goals together, the sum of costs minimised.

    Args:
        problem: facts, numbers, actions and goals.
        facts: (F,) bool at the start.
        numbers: (K,) readings at the start.
        goals: indices of the goals that shall hold together at the end.

    """
    return _Writer(problem).problem(facts, [exact(float(value)) for value in numbers], goals)


def write_pddl(
    problem: PlanningProblem, facts: npt.NDArray[np.bool_], numbers: npt.NDArray[np.float64], goals: Sequence[int]
) -> tuple[str, str]:
    """Return the texts of a PDDL domain and problem; the arguments are those of `to_unified`.

    Names lose what PDDL does not allow in names; the order of actions stays.
    """
    writer = import_module("unified_planning.io").PDDLWriter(to_unified(problem, facts, numbers, goals))
    return writer.get_domain(), writer.get_problem()


def exact(value: float) -> Fraction:
    """Return a value as the fraction that the built-in search works with."""
    return Fraction(in_steps(value), STEPS_PER_UNIT)


class _Writer:
    """Builds the library's problem out of ours."""

    def __init__(self, problem: PlanningProblem) -> None:
        self.source = problem
        self.env = environment()
        self.make = self.env.expression_manager
        self.model = import_module("unified_planning.model")

    def problem(self, facts: npt.NDArray[np.bool_], numbers: Sequence[Fraction], goals: Sequence[int]) -> Any:  # noqa: ANN401
        target = self.model.Problem("clean-swarm", self.env)
        types = self.env.type_manager
        self.facts = [self.model.Fluent(name, types.BoolType(), environment=self.env) for name in self.source.facts]
        self.numbers = [
            self.model.Fluent(name, types.IntType() if integer else types.RealType(), environment=self.env)
            for name, integer in zip(self.source.numbers, self._whole_numbers(numbers), strict=True)
        ]
        for fluent, fact in zip(self.facts, facts, strict=True):
            target.add_fluent(fluent, default_initial_value=bool(fact))
        for fluent, value in zip(self.numbers, numbers, strict=True):
            target.add_fluent(fluent, default_initial_value=self.constant(value))
        actions = [self.action(index) for index in range(len(self.source.actions))]
        target.add_actions(actions)
        for goal in goals:
            target.add_goal(self.expression(self.source.goals[goal].condition))
        costs = {a: self.constant(exact(b.cost)) for a, b in zip(actions, self.source.actions, strict=True)}
        metrics = import_module("unified_planning.model.metrics")
        target.add_quality_metric(metrics.MinimizeActionCosts(costs, environment=self.env))
        return target

    def action(self, index: int) -> Any:  # noqa: ANN401
        source = self.source.actions[index]
        target = self.model.InstantaneousAction(source.name, _env=self.env)
        for precondition in source.preconditions:
            target.add_precondition(self.expression(precondition))
        for effect in source.effects:
            if isinstance(effect, SetFact):
                target.add_effect(self.facts[effect.fact], effect.value)
            elif effect.change > 0.0:
                target.add_increase_effect(self.numbers[effect.number], self.constant(exact(effect.change)))
            elif effect.change < 0.0:
                target.add_decrease_effect(self.numbers[effect.number], self.constant(exact(-effect.change)))
        return target

    def expression(self, expression: Expression) -> Any:  # noqa: ANN401
        match expression:
            case FactIs(fact, wanted):
                reading = self.make.FluentExp(self.facts[fact])
                return reading if wanted else self.make.Not(reading)
            case NumberIs(number, relation, value):
                compare = {">=": self.make.GE, "<=": self.make.LE, ">": self.make.GT, "<": self.make.LT}[relation]
                return compare(self.make.FluentExp(self.numbers[number]), self.constant(exact(value)))
            case Not(part):
                return self.make.Not(self.expression(part))
            case AllOf(parts):
                return self.make.And([self.expression(part) for part in parts])
            case AnyOf(parts):
                return self.make.Or([self.expression(part) for part in parts])

    def constant(self, value: Fraction) -> Any:  # noqa: ANN401
        return self.make.Int(value.numerator) if value.denominator == 1 else self.make.Real(value)

    def _whole_numbers(self, readings: Sequence[Fraction]) -> list[bool]:
        """Say which numbers (K,) start, change and are bounded at whole values only."""
        fractional = {number for number, value in enumerate(readings) if value.denominator != 1}
        for number, value in constants(self.source):
            if exact(value).denominator != 1:
                fractional.add(number)
        return [number not in fractional for number in range(len(readings))]
