"""A naive planner over dictionaries of names, written from the description alone, to compare with."""

import heapq
from dataclasses import dataclass

import numpy as np

from selforg.network.planning.problem import STEPS_PER_UNIT, PlanningProblem, all_of


@dataclass(frozen=True)
class World:
    facts: tuple[bool, ...]
    numbers: tuple[float, ...]


def true_in(condition, world):
    bits = sum(value << slot for slot, value in enumerate(world.facts))
    steps = [round(number * STEPS_PER_UNIT) for number in world.numbers]
    return (
        bits & condition.mask == condition.want
        and all((steps[slot] >= crossing) == above for slot, crossing, above in condition.tests)
        and all(any(true_in(option, world) for option in options) for options in condition.choices)
    )


def after(action, world):
    facts = [bool(action.gain >> k & 1 or (value and action.keep >> k & 1)) for k, value in enumerate(world.facts)]
    numbers = list(world.numbers)
    for slot, change in action.changes:
        numbers[slot] += change / STEPS_PER_UNIT
    return World(tuple(facts), tuple(numbers))


def best_plan(problem: PlanningProblem, facts, numbers, goals, most_states=300):
    """Return (cost, steps, actions), None if there is no plan, or "too large"."""
    wanted = all_of(problem.goals[goal].condition for goal in goals)
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
            if true_in(action.guard, world):
                longer = (*sequence, index)
                worlds[longer] = after(action, world)
                heapq.heappush(queue, (cost + action.cost / STEPS_PER_UNIT, steps + 1, longer))
    return None


def execute(problem: PlanningProblem, facts, numbers, actions):
    """Return the world after the actions, checking that each is allowed where it is taken."""
    world = World(tuple(map(bool, facts)), tuple(map(float, numbers)))
    for index in actions:
        assert true_in(problem.actions[index].guard, world), problem.actions[index].name
        world = after(problem.actions[index], world)
    return world


def as_arrays(world):
    return np.array(world.facts, dtype=bool), np.array(world.numbers, dtype=float)
