"""From a network model to plans: the planning problem it poses, and the planner that answers for its rows.

Facts are set by the sign of an effect, numbers change by its size. A precondition must be satisfied to the behaviour's
ready threshold, a goal's condition to the goal's threshold. Optional preconditions and planner-independent behaviours
take no part.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np

from selforg.network.model.activators import Activator, Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Interface
from selforg.network.model.conditions import Condition, Conjunction, Negation, Optional, Tree
from selforg.network.model.model import NetworkModel
from selforg.network.model.packed import Floats, Ints
from selforg.network.planning.guards import FactTest, NumberTest, all_tests, make_guard, make_step
from selforg.network.planning.memory import PlanMemory
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
from selforg.network.planning.search import ForwardSearch, Plan, Search
from selforg.network.planning.spending import SpendingSearch, spent_numbers
from selforg.network.planning.task import PlanTask

ALWAYS, NEVER = AllOf(()), AnyOf(())


class Planner(ABC):
    """Answers for one row. Called only when a row needs a plan that is not remembered."""

    memory: PlanMemory

    @abstractmethod
    def plan(self, readings: Floats, alternatives: Ints, goal_enabled: Ints) -> list[int] | None:
        """Return the behaviours of a plan in their order, None if there is none.

        Args:
            readings: (S,) of one row.
            alternatives: (B,) which of its alternatives each behaviour holds, -1: none.
            goal_enabled: (G,) 1 where a goal is on.

        """


class BuiltInPlanner(Planner):
    """Plans for the model's own planning problem, goals by priority.

    `make_search` makes what searches one problem: the built-in forward search, or an engine in its place (see
    `planner_named`).
    """

    def __init__(self, model: NetworkModel, make_search: Callable[[PlanningProblem], Search] = ForwardSearch) -> None:
        self.model = model
        self._make_search = make_search
        self._searches: dict[tuple[int, ...], SpendingSearch] = {}
        self._columns = _Columns(model)
        self._coordinators = [b for b, behaviour in enumerate(model.behaviours) if behaviour.alternatives]
        self._task = self._make_task()
        self._spent = spent_numbers(self._task)
        self.memory = self._make_memory()

    def plan(self, readings: Floats, alternatives: Ints, goal_enabled: Ints) -> list[int] | None:
        """Behaviours in order for one row; None if no goal has a plan."""
        held = tuple(int(alternatives[b]) for b in self._coordinators)
        if held not in self._searches:
            self._searches[held] = SpendingSearch(self._problem(held), self._make_search, self._spent)
        search = self._searches[held]
        wanted = np.flatnonzero(goal_enabled).tolist()
        facts, numbers = readings[self._columns.facts] > 0.5, readings[self._columns.numbers]
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
            self._columns.action(
                behaviour, [face for tag, face in behaviour.interfaces if tag < 0 or tag == choice.get(b)]
            )
            for b, behaviour in enumerate(self.model.behaviours)
            if not behaviour.planner_independent
        ]
        return self._columns.problem(actions)

    def _make_task(self) -> PlanTask:
        """Return the task of all goals with all that behaviours do in any combination of alternatives."""
        actions = []
        for behaviour in self.model.behaviours:
            if not behaviour.planner_independent:
                always, *others = behaviour.interfaces
                actions.append(self._columns.action(behaviour, [always[1]]))
                actions += [self._columns.action(behaviour, [always[1], other[1]]) for other in others]
        steps = tuple(make_step(k, action) for k, action in enumerate(actions))
        goal = make_guard(AllOf(tuple(goal.condition for goal in self._columns.goals)))
        return PlanTask(steps, goal, len(self._columns.numbers))

    def _make_memory(self) -> PlanMemory:
        """Return a memory whose keys tell apart whatever any combination of alternatives could depend on."""
        task = self._task
        tests = [*all_tests(task.goal), *(test for step in task.steps for test in all_tests(step.guard))]
        facts = sorted({test.slot for test in tests if isinstance(test, FactTest)})
        read = {test.slot for test in tests if isinstance(test, NumberTest)}
        return PlanMemory(
            [self._columns.facts[slot] for slot in facts],
            [(self._columns.numbers[scale.slot], scale) for scale in task.scales if scale.slot in read],
            self._coordinators,
            len(self.model.goals),
            {self._columns.numbers[number.slot]: number for number in self._spent},
        )


class _Columns:
    """Which sensor is which fact or number of the problem, and the translation of what refers to them."""

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
        names = [sensor.name for sensor in self.model.sensors]
        facts, numbers = tuple(names[k] for k in self.facts), tuple(names[k] for k in self.numbers)
        return PlanningProblem(facts, numbers, tuple(actions), tuple(self.goals))

    def action(self, behaviour: Behaviour, interfaces: Sequence[Interface]) -> PlanningAction:
        trees = [p for face in interfaces for p in face.preconditions if not isinstance(p, Optional)]
        preconditions = tuple(self.reaches(tree, behaviour.ready_threshold) for tree in trees)
        effects = tuple(self.effect(e.sensor, e.change) for face in interfaces for e in face.effects if e.change)
        return PlanningAction(behaviour.name, preconditions, _last_wins(effects), behaviour.cost)

    def effect(self, sensor: str, change: float) -> PlanEffect:
        column = self.model.sensor_index[sensor]
        if column in self.facts:
            return SetFact(self.facts.index(column), change > 0.0)
        return ChangeNumber(self.numbers.index(column), change)

    def reaches(self, tree: Tree, level: float, above: bool = True) -> Expression:
        """Say that a tree's satisfaction is at least `level` (at most, if not `above`).

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
            return ALWAYS
        if (high < level) if above else (low > level):
            return NEVER
        if isinstance(activator, Linear):
            at = activator.zero + (level - low) / (high - low) * (activator.full - activator.zero)
            return NumberIs(self.numbers.index(column), ">=" if (activator.direction > 0.0) is above else "<=", at)
        fulfilled = self._fulfilled(activator, column)
        return fulfilled if above else Not(fulfilled)

    def _fulfilled(self, activator: Activator, column: int) -> Expression:
        if isinstance(activator, Greedy):
            return ALWAYS if activator.step_size == 0.0 else NEVER
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
        return AnyOf(tuple(FactIs(fact, value) for value in values)) if len(values) < 2 else ALWAYS


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
