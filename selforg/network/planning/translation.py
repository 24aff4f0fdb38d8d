"""From a network model to its planning problem.

Facts are set by the sign of an effect, numbers change by its size. A precondition must be satisfied to the behaviour's
ready threshold, a goal's condition to the goal's threshold. Optional preconditions take no part.
"""

from __future__ import annotations

from collections.abc import Sequence

from selforg.network.model.activators import Activator, Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Interface
from selforg.network.model.conditions import Condition, Conjunction, Negation, Optional, Tree
from selforg.network.model.model import NetworkModel
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
    SetFact,
)

TRUE, FALSE = AllOf(()), AnyOf(())


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
                AllOf(tuple(self.reaches(tree, goal.satisfaction_threshold) for tree in goal.conditions)),
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
        preconditions = tuple(self.reaches(tree, behaviour.ready_threshold) for tree in trees)
        effects = tuple(self.effect(e.sensor, e.change) for face in interfaces for e in face.effects if e.change)
        return PlanningAction(behaviour.name, preconditions, _last_wins(effects), behaviour.cost)

    def effect(self, sensor: str, change: float) -> PlanEffect:
        """Return what a change of a sensor does to the problem's state."""
        column = self.model.sensor_index[sensor]
        if column in self.facts:
            return SetFact(self.facts.index(column), change > 0.0)
        return ChangeNumber(self.numbers.index(column), change)

    def reaches(self, tree: Tree, level: float, above: bool = True) -> Expression:
        """Return the expression that a tree's satisfaction is at least `level` (at most, if not `above`).

        Of a conjunction, whose satisfaction is a product, every part must reach the level by itself.
        """
        if isinstance(tree, Condition):
            return self._leaf(tree, level, above)
        if isinstance(tree, Negation):
            return self.reaches(tree.of, 1.0 - level, not above)
        parts = tuple(self.reaches(part, level, above) for part in tree.of)
        return AllOf(parts) if isinstance(tree, Conjunction) is above else AnyOf(parts)

    def _leaf(self, condition: Condition, level: float, above: bool) -> Expression:
        activator, column = condition.activator, self.model.sensor_index[condition.sensor]
        low, high = activator.low, activator.high
        if (low >= level) if above else (high <= level):
            return TRUE
        if (high < level) if above else (low > level):
            return FALSE
        if isinstance(activator, Linear):
            at = activator.zero + (level - low) / (high - low) * (activator.full - activator.zero)
            return NumberIs(self.numbers.index(column), ">=" if (activator.direction > 0.0) is above else "<=", at)
        fulfilled = self._fulfilled(activator, column)
        return fulfilled if above else Not(fulfilled)

    def _fulfilled(self, activator: Activator, column: int) -> Expression:
        if isinstance(activator, Greedy):
            return TRUE if activator.step_size == 0.0 else FALSE
        if column in self.facts:
            return self._fulfilled_by_fact(activator, self.facts.index(column))
        number = self.numbers.index(column)
        if isinstance(activator, Threshold):
            return NumberIs(number, ">=" if activator.minimum else "<=", activator.threshold)
        if isinstance(activator, Equal):
            return AllOf((NumberIs(number, ">=", activator.value), NumberIs(number, "<=", activator.value)))
        raise TypeError(f"no planning form for {type(activator).__name__}")

    def _fulfilled_by_fact(self, activator: Activator, fact: int) -> Expression:
        values = [value for value in (False, True) if _accepts(activator, float(value))]
        return AnyOf(tuple(FactIs(fact, value) for value in values)) if len(values) < 2 else TRUE


def _accepts(activator: Activator, value: float) -> bool:
    if isinstance(activator, Boolean):
        return value == float(activator.desired)
    if isinstance(activator, Threshold):
        return value >= activator.threshold if activator.minimum else value <= activator.threshold
    return isinstance(activator, Equal) and value == activator.value


def _last_wins(effects: Sequence[PlanEffect]) -> tuple[PlanEffect, ...]:
    """Keep one effect on a fact: the last one declared."""
    facts = {effect.fact: effect for effect in effects if isinstance(effect, SetFact)}
    return (*facts.values(), *(effect for effect in effects if isinstance(effect, ChangeNumber)))
