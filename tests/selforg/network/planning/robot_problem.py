"""The cleaning robot of docs/network.md as a planning problem, written by hand."""

import numpy as np

from selforg.network.planning.problem import (
    PlanningGoal,
    PlanningProblem,
    fact_is,
    number_is,
    planning_action,
)

FACTS = (
    *("garbage_seen", "garbage_at", "carrying", "recycled", "garbage_found"),
    *("at_recycling", "at_dump", "patrolled", "rep_bool"),
)
NUMBERS = ("dist_recycling", "dist_dump", "rep_len")

# name: (preconditions, effects); a number as precondition means that the linear condition is worth the threshold 0.05
BEHAVIOURS = {
    "MoveToGarbage": ("garbage_seen !garbage_at !carrying", "+garbage_at"),
    "PickGarbage": ("garbage_at !carrying", "+carrying -garbage_at"),
    "MoveToRecycling": ("carrying !recycled dist_recycling !at_recycling", "-dist_recycling +at_recycling"),
    "Recycle": ("carrying !recycled at_recycling", "+recycled"),
    "MoveToDump": ("carrying recycled dist_dump !at_dump", "-dist_dump +at_dump"),
    "Dump": ("carrying recycled at_dump", "-carrying -recycled -garbage_found"),
    "Patrol": ("!garbage_found", "+patrolled +garbage_seen"),
    "Avoid": ("rep_bool", "-rep_len -rep_bool"),
}
GOALS = {"PatrolEnvironment": "patrolled", "GarbageCleaned": "!garbage_found", "AvoidCollision": "!rep_bool"}


def condition(word):
    if word in NUMBERS:
        return number_is(NUMBERS.index(word), ">=", 0.05)
    return fact_is(FACTS.index(word.removeprefix("!")), not word.startswith("!"))


def effect(word):
    sign, name = word[0] == "+", word[1:]
    return (NUMBERS.index(name), 1.0 if sign else -1.0) if name in NUMBERS else (FACTS.index(name), sign)


def robot_problem():
    actions = tuple(
        planning_action(name, tuple(map(condition, before.split())), tuple(map(effect, effects.split())))
        for name, (before, effects) in BEHAVIOURS.items()
    )
    goals = tuple(PlanningGoal(name, condition(word)) for name, word in GOALS.items())
    return PlanningProblem(FACTS, NUMBERS, actions, goals)


def robot_state(*true, recycling=3.3, dump=5.5, avoidance=0.0):
    """Return facts (9,) and numbers (3,) of a robot for which these facts are true."""
    assert set(true) <= set(FACTS)
    return np.array([name in true for name in FACTS]), np.array([recycling, dump, avoidance])
