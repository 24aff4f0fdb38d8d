"""From a network model to its planning problem.

Facts are set by the sign of an effect, numbers change by its size. A precondition must be satisfied to the behaviour's
ready threshold, a goal's condition to the goal's threshold. Optional preconditions take no part.
"""

from __future__ import annotations

from collections.abc import Sequence

from selforg.network.model.activators import GREEDY_RULE, LINEAR_RULE, THRESHOLD_RULE, Activator
from selforg.network.model.behaviours import Behaviour, Interface
from selforg.network.model.conditions import Condition, Conjunction, Negation, Optional, Tree
from selforg.network.model.model import NetworkModel
from selforg.network.planning.problem import (
    Effect,
    Guard,
    PlanningAction,
    PlanningGoal,
    PlanningProblem,
    Relation,
    all_of,
    any_of,
    fact_is,
    number_is,
    planning_action,
)

TRUE, FALSE = all_of(()), any_of(())


class Translation:
    """Which sensor of a model is which fact or number of its problem, and the translation of what refers to them.

    Attributes:
        facts: columns of the sensors that are facts.
        numbers: columns of the sensors that are numbers.
        goals: of the problem.

    """

    def __init__(self, model: NetworkModel) -> None:
        self.model = model
        self.facts = [k for k, sensor in enumerate(model.sensors) if sensor.kind == "fact"]
        self.numbers = [k for k, sensor in enumerate(model.sensors) if sensor.kind == "number"]
        self.goals = [
            PlanningGoal(
                goal.name,
                all_of(self.reaches(tree, goal.satisfaction_threshold) for tree in goal.conditions),
                goal.priority,
            )
            for goal in model.goals
        ]

    def problem(self, actions: Sequence[PlanningAction]) -> PlanningProblem:
        """Return the problem of the model with these actions."""
        names = [sensor.name for sensor in self.model.sensors]
        facts, numbers = tuple(names[k] for k in self.facts), tuple(names[k] for k in self.numbers)
        return PlanningProblem(facts, numbers, tuple(actions), tuple(self.goals))

    def action(self, behaviour: Behaviour, interfaces: Sequence[Interface]) -> PlanningAction:
        """Return a behaviour that shows these interfaces as an action."""
        trees = [p for face in interfaces for p in face.preconditions if not isinstance(p, Optional)]
        preconditions = [self.reaches(tree, behaviour.ready_threshold) for tree in trees]
        return planning_action(behaviour.name, preconditions, self._effects(interfaces), behaviour.cost)

    def _effects(self, interfaces: Sequence[Interface]) -> list[Effect]:
        """Return what the effects of interfaces do to the problem's state; of several on one fact the last counts."""
        facts: dict[int, bool] = {}
        changes: list[Effect] = []
        for effect in (effect for face in interfaces for effect in face.effects if effect.change):
            column = self.model.sensor_index[effect.sensor]
            if column in self.facts:
                facts[self.facts.index(column)] = bool(effect.change > 0.0)
            else:
                changes.append((self.numbers.index(column), effect.change))
        return [*facts.items(), *changes]

    def reaches(self, tree: Tree, level: float, above: bool = True) -> Guard:
        """Return the condition that a tree's satisfaction is at least `level` (at most, if not `above`).

        Of a conjunction, whose satisfaction is a product, every part must reach the level by itself.
        """
        if isinstance(tree, Condition):
            return self._leaf(tree, level, above)
        if isinstance(tree, Negation):
            return self.reaches(tree.of, 1.0 - level, not above)
        parts = [self.reaches(part, level, above) for part in tree.of]
        return all_of(parts) if isinstance(tree, Conjunction) is above else any_of(parts)

    def _leaf(self, condition: Condition, level: float, above: bool) -> Guard:
        activator, column = condition.activator, self.model.sensor_index[condition.sensor]
        low, high = activator.low, activator.high
        if (low >= level) if above else (high <= level):
            return TRUE
        if (high < level) if above else (low > level):
            return FALSE
        if activator.kind == LINEAR_RULE:
            zero, full, _ = activator.parameters
            at = zero + (level - low) / (high - low) * (full - zero)
            return number_is(self.numbers.index(column), ">=" if (activator.direction > 0.0) is above else "<=", at)
        if activator.kind == GREEDY_RULE:
            return TRUE if (activator.parameters[0] == 0.0) == above else FALSE
        if column in self.facts:
            fact = self.facts.index(column)
            values = [value for value in (False, True) if _accepts(activator, float(value)) == above]
            return TRUE if len(values) == 2 else any_of(fact_is(fact, value) for value in values)
        return _bound(activator, self.numbers.index(column), above)


def _bound(activator: Activator, number: int, fulfilled: bool) -> Guard:
    """Return the condition that an activator is fulfilled by a number, or is not."""
    reached: Relation = ">=" if fulfilled else ">"
    not_passed: Relation = "<=" if fulfilled else "<"
    at = activator.parameters[0]
    if activator.kind == THRESHOLD_RULE:
        return number_is(number, reached if (activator.direction > 0.0) == fulfilled else not_passed, at)
    bounds = number_is(number, reached, at), number_is(number, not_passed, at)
    return all_of(bounds) if fulfilled else any_of(bounds)


def _accepts(activator: Activator, value: float) -> bool:
    at = activator.parameters[0]
    if activator.kind == THRESHOLD_RULE:
        return value >= at if activator.direction > 0.0 else value <= at
    return value == at
