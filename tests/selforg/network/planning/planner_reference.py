"""A naive planner over dictionaries of names, written from the description alone, to compare with."""

import heapq
import operator
from dataclasses import dataclass

import numpy as np

from selforg.network.planning.problem import AllOf, AnyOf, FactIs, Not, NumberIs, PlanningProblem, SetFact

RELATIONS = {">=": operator.ge, "<=": operator.le, ">": operator.gt, "<": operator.lt}


@dataclass(frozen=True)
class World:
    facts: tuple[bool, ...]
    numbers: tuple[float, ...]


def true_in(expression, world):
    match expression:
        case FactIs(fact, wanted):
            return world.facts[fact] == wanted
        case NumberIs(number, relation, value):
            return RELATIONS[relation](world.numbers[number], value)
        case Not(part):
            return not true_in(part, world)
        case AllOf(parts):
            return all(true_in(part, world) for part in parts)
        case AnyOf(parts):
            return any(true_in(part, world) for part in parts)
    raise AssertionError(expression)


def after(action, world):
    facts, numbers = list(world.facts), list(world.numbers)
    for effect in action.effects:
        if isinstance(effect, SetFact):
            facts[effect.fact] = effect.value
        else:
            numbers[effect.number] += effect.change
    return World(tuple(facts), tuple(numbers))


def best_plan(problem: PlanningProblem, facts, numbers, goals, most_states=300):
    """Return (cost, steps, actions), None if there is no plan, or "too large"."""
    wanted = AllOf(tuple(problem.goals[goal].condition for goal in goals))
    queue = [(0, 0, ())]
    worlds = {(): World(tuple(map(bool, facts)), tuple(map(float, numbers)))}
    closed = set()
    while queue:
        cost, steps, sequence = heapq.heappop(queue)
        world = worlds.pop(sequence)
        if world in closed:
            continue
        if true_in(wanted, world):
            return cost, steps, sequence
        if len(closed) >= most_states:
            return "too large"
        closed.add(world)
        for index, action in enumerate(problem.actions):
            if true_in(AllOf(action.preconditions), world):
                longer = (*sequence, index)
                worlds[longer] = after(action, world)
                heapq.heappush(queue, (cost + action.cost, steps + 1, longer))
    return None


def execute(problem: PlanningProblem, facts, numbers, actions):
    """Return the world after the actions, checking that each is allowed where it is taken."""
    world = World(tuple(map(bool, facts)), tuple(map(float, numbers)))
    for index in actions:
        assert true_in(AllOf(problem.actions[index].preconditions), world), problem.actions[index].name
        world = after(problem.actions[index], world)
    return world


def as_arrays(world):
    return np.array(world.facts, dtype=bool), np.array(world.numbers, dtype=float)
