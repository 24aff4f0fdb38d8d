"""Small problems drawn at random: robots that need facts and charge, some of them unsolvable."""

import numpy as np

from selforg.network.planning.problem import (
    PlanningGoal,
    PlanningProblem,
    all_of,
    any_of,
    fact_is,
    number_is,
    planning_action,
)

FACTS, ACTIONS = 6, 6


def generated(seed):
    """Return a problem of 6 facts, at most one number and 6 actions, with the facts and numbers it starts from."""
    draw = np.random.default_rng(seed)
    numeric = bool(draw.integers(2))
    actions = tuple(action(index, draw, numeric) for index in range(ACTIONS))
    wanted = [fact_is(int(fact)) for fact in 1 + draw.choice(FACTS - 1, 2, replace=False)]
    goal = PlanningGoal("goal", all_of((*wanted, *((some_bound(draw),) if numeric else ()))))
    problem = PlanningProblem(tuple("abcdef"), ("charge",) if numeric else (), actions, (goal,))
    facts = draw.random(FACTS) < 0.1
    facts[0] = True
    return problem, facts, np.round(draw.uniform(0.0, 2.0, size=int(numeric)), 3)


def action(index, draw, numeric):
    """Return an action that reaches a fact from another one, often at the price of a third, sometimes for charge."""
    reached = 1 + index % (FACTS - 1)  # each fact but the first has a servant, so that many problems are solvable
    given, lost = int(draw.integers(reached)), int(draw.integers(FACTS))
    preconditions = [fact_is(given)]
    if draw.random() < 0.3:
        preconditions.append(any_of((some_fact(draw), some_fact(draw))))
    effects = [(reached, True)]
    if lost != reached and draw.random() < 0.8:
        effects.append((lost, False))
    if numeric and draw.random() < 0.6:
        effects.append((0, float(draw.choice([-0.5, 0.5, 1.5]))))
    if numeric and draw.random() < 0.3:
        preconditions.append(some_bound(draw))
    return planning_action(
        f"action{index}", tuple(preconditions), tuple(effects), float(draw.choice([1.0, 1.0, 1.5, 2.5]))
    )


def some_fact(draw):
    return fact_is(int(draw.integers(FACTS)), bool(draw.random() < 0.7))


def some_bound(draw):
    return number_is(0, str(draw.choice([">=", "<=", ">", "<"])), float(draw.choice([0.5, 1.0, 2.0])))
