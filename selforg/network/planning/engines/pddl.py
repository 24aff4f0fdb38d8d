"""Problems of the unified-planning library, and PDDL read by it, as planning problems of ours."""

from fractions import Fraction
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from selforg.network.planning.engines.unified import environment
from selforg.network.planning.problem import (
    AllOf,
    AnyOf,
    ChangeNumber,
    Expression,
    FactIs,
    Not,
    NumberIs,
    PlanEffect,
    PlanningAction,
    PlanningGoal,
    PlanningProblem,
    Relation,
    SetFact,
)

Start = tuple[npt.NDArray[np.bool_], npt.NDArray[np.float64]]
MIRRORED: dict[Relation, Relation] = {">=": "<=", "<=": ">=", ">": "<", "<": ">"}


def read_pddl(domain: str, problem: str) -> tuple[PlanningProblem, Start]:
    """Return the problem that PDDL texts pose, and the facts (F,) and numbers (K,) it starts from.

    Raises:
        ValueError: the texts use what a planning problem here cannot hold, such as conditional effects.

    """
    environment()  # raises an error that says what to install
    reader = import_module("unified_planning.io").PDDLReader(environment())
    return from_unified(reader.parse_problem_string(domain, problem))


def from_unified(source: Any) -> tuple[PlanningProblem, Start]:  # noqa: ANN401  (optional library)
    """Return a problem of the library as one of ours, its goals as one goal, and the start.

    Actions with parameters are grounded. The library's problem must be Boolean and numeric without conditional effects,
    numbers must be compared with constants and changed by constants.
    """
    if any(action.parameters for action in source.actions):
        engines = import_module("unified_planning.engines")
        kind = engines.CompilationKind.GROUNDING
        with environment().factory.Compiler(problem_kind=source.kind, compilation_kind=kind) as compiler:
            source = compiler.compile(source, kind).problem
    return _Reader(source).result()


class _Reader:
    """Builds our problem out of the library's."""

    def __init__(self, source: Any) -> None:  # noqa: ANN401
        self.source = source
        self.simplify = source.environment.simplifier.simplify
        values = {str(fluent): (fluent, value) for fluent, value in source.initial_values.items()}
        self.start_facts = {name: value for name, (fluent, value) in values.items() if fluent.type.is_bool_type()}
        self.start_numbers = {name: value for name, (fluent, value) in values.items() if name not in self.start_facts}
        self.facts = tuple(self.start_facts)
        self.numbers = tuple(self.start_numbers)

    def result(self) -> tuple[PlanningProblem, Start]:
        costs = self._costs()
        actions = tuple(self._action(action, costs) for action in self.source.actions)
        goal = AllOf(tuple(self.expression(self.simplify(goal)) for goal in self.source.goals))
        problem = PlanningProblem(self.facts, self.numbers, actions, (PlanningGoal("goal", goal),))
        facts = np.array([value.bool_constant_value() for value in self.start_facts.values()], dtype=np.bool_)
        numbers = np.array([float(_constant(value)) for value in self.start_numbers.values()], dtype=np.float64)
        return problem, (facts, numbers)

    def expression(self, node: Any) -> Expression:  # noqa: ANN401
        if node.is_bool_constant():
            return AllOf(()) if node.bool_constant_value() else AnyOf(())
        if node.is_fluent_exp():
            return FactIs(self.facts.index(str(node)))
        if node.is_not():
            return Not(self.expression(node.arg(0)))
        parts = tuple(node.args)
        if node.is_and():
            return AllOf(tuple(self.expression(part) for part in parts))
        if node.is_or():
            return AnyOf(tuple(self.expression(part) for part in parts))
        if node.is_implies():
            return AnyOf((Not(self.expression(parts[0])), self.expression(parts[1])))
        if node.is_equals():
            return AllOf((self._bound(node, ">="), self._bound(node, "<=")))
        if node.is_le() or node.is_lt():
            return self._bound(node, "<=" if node.is_le() else "<")
        raise ValueError(f"expected facts, and numbers compared with constants, got {node}")

    def _bound(self, node: Any, relation: Relation) -> NumberIs:  # noqa: ANN401
        left, right = node.args
        if right.is_fluent_exp():
            left, right, relation = right, left, MIRRORED[relation]
        if not (left.is_fluent_exp() and str(left) in self.numbers and right.is_constant()):
            raise ValueError(f"expected a number compared with a constant, got {node}")
        return NumberIs(self.numbers.index(str(left)), relation, float(_constant(right)))

    def _action(self, source: Any, costs: dict[str, float]) -> PlanningAction:  # noqa: ANN401
        preconditions = tuple(self.expression(self.simplify(part)) for part in source.preconditions)
        effects = tuple(self._effect(effect, source.name) for effect in source.effects)
        return PlanningAction(source.name, preconditions, effects, costs[source.name])

    def _effect(self, effect: Any, action: str) -> PlanEffect:  # noqa: ANN401
        name, value = str(effect.fluent), self.simplify(effect.value)
        if effect.is_conditional() or not value.is_constant():
            raise ValueError(f"action '{action}': expected an unconditional, constant effect, got {effect}")
        if name in self.facts:
            return SetFact(self.facts.index(name), value.bool_constant_value())
        if effect.is_assignment():
            raise ValueError(f"action '{action}': expected an increase or a decrease of '{name}', got {effect}")
        change = float(_constant(value))
        return ChangeNumber(self.numbers.index(name), change if effect.is_increase() else -change)

    def _costs(self) -> dict[str, float]:
        """Return the cost of each action: by the metric, or 1 without one."""
        names = [action.name for action in self.source.actions]
        if not self.source.quality_metrics:
            return dict.fromkeys(names, 1.0)
        metric = self.source.quality_metrics[0]
        if len(self.source.quality_metrics) > 1 or not (
            metric.is_minimize_action_costs() or metric.is_minimize_sequential_plan_length()
        ):
            raise ValueError(f"expected the sum of costs or the number of steps to be minimised, got {metric}")
        if metric.is_minimize_sequential_plan_length():
            return dict.fromkeys(names, 1.0)
        given = {action.name: metric.get_action_cost(action) for action in self.source.actions}
        return {name: 0.0 if cost is None else float(_constant(self.simplify(cost))) for name, cost in given.items()}


def _constant(node: Any) -> Fraction:  # noqa: ANN401
    """Return the value of a numeric constant."""
    return Fraction(node.constant_value())
