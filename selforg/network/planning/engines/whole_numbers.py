"""The same planning problem in whole numbers, for engines that know no others.

All changes of a number are whole multiples of its grid g; with the reading x = k g + r, the remainder r never changes
and k counts grid steps. A bound x >= c is then k >= ceil((c - r) / g). Costs are counted in their own common step.
Nothing is rounded: a plan solves one problem exactly if it solves the other.
"""

from dataclasses import replace
from functools import reduce
from math import gcd

from selforg.network.planning.guards import in_steps
from selforg.network.planning.problem import (
    AllOf,
    AnyOf,
    ChangeNumber,
    Expression,
    FactIs,
    Not,
    NumberIs,
    PlanEffect,
    PlanningProblem,
)
from selforg.network.planning.search import State

FREE_GRID = 1 << 62
"""Grid of a number that nothing changes: so wide that only the truth of its bounds is left."""


def in_whole_numbers(problem: PlanningProblem, state: State) -> tuple[PlanningProblem, tuple[int, ...]]:
    """Return the problem whose numbers count grid steps, and its readings (K,), for a start in `state`.

    The returned problem uses its numbers as they are: bounds, changes and costs are whole floats.
    """
    grids = [_grid(problem, number) for number in range(len(problem.numbers))]
    remainders = [value % grid for value, grid in zip(state[1], grids, strict=True)]
    cost_step = reduce(gcd, (in_steps(action.cost) for action in problem.actions), 0) or 1
    counted = _Counting(grids, remainders)
    actions = tuple(
        replace(
            action,
            preconditions=tuple(counted.expression(part) for part in action.preconditions),
            effects=tuple(counted.effect(effect) for effect in action.effects),
            cost=float(in_steps(action.cost) // cost_step),
        )
        for action in problem.actions
    )
    goals = tuple(replace(goal, condition=counted.expression(goal.condition)) for goal in problem.goals)
    readings = tuple(value // grid for value, grid in zip(state[1], grids, strict=True))
    return replace(problem, actions=actions, goals=goals), readings


def _grid(problem: PlanningProblem, number: int) -> int:
    """Return the largest step that all changes of a number are multiples of."""
    effects = [effect for action in problem.actions for effect in action.effects]
    changes = [in_steps(e.change) for e in effects if isinstance(e, ChangeNumber) and e.number == number]
    return reduce(gcd, changes, 0) or FREE_GRID


class _Counting:
    """The translation of bounds and changes, given the grid and the remainder of every number."""

    def __init__(self, grids: list[int], remainders: list[int]) -> None:
        self.grids = grids
        self.remainders = remainders

    def expression(self, expression: Expression) -> Expression:
        match expression:
            case FactIs():
                return expression
            case NumberIs(number, relation, value):
                crossing = in_steps(value) + (relation in ("<=", ">"))
                steps = -((self.remainders[number] - crossing) // self.grids[number])
                return NumberIs(number, ">=" if relation in (">=", ">") else "<", float(steps))
            case Not(part):
                return Not(self.expression(part))
            case AllOf(parts):
                return AllOf(tuple(self.expression(part) for part in parts))
            case AnyOf(parts):
                return AnyOf(tuple(self.expression(part) for part in parts))

    def effect(self, effect: PlanEffect) -> PlanEffect:
        if isinstance(effect, ChangeNumber):
            return ChangeNumber(effect.number, float(in_steps(effect.change) // self.grids[effect.number]))
        return effect
