"""The cleaning robot of docs/network.md as a network model, its avoidance a plain behaviour, and readings for it."""

import numpy as np

from selforg.network.model.activators import Boolean, Linear
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition, Negation, Optional
from selforg.network.model.model import NetworkModel

FACTS = (
    *("garbage_seen", "garbage_at", "garbage_found", "carrying", "recycled"),
    *("at_recycling", "at_dump", "patrolled", "rep_bool"),
)
NUMBERS = ("dist_recycling", "dist_dump", "rep_len")
SENSORS = (*(Sensor(name, "fact") for name in FACTS), *(Sensor(name) for name in NUMBERS))

TASKS = {  # name: (preconditions, effects, ready threshold); ~ marks a distance that has to be large enough
    "Patrol": ("!garbage_found", "+patrolled +garbage_seen", 0.8),
    "MoveToGarbage": ("garbage_seen !garbage_at !carrying", "+garbage_at", 0.8),
    "PickGarbage": ("garbage_at !carrying", "+carrying -garbage_at", 0.8),
    "MoveToRecycling": ("carrying !recycled ~dist_recycling !at_recycling", "-dist_recycling +at_recycling", 0.05),
    "Recycle": ("carrying !recycled at_recycling", "+recycled", 0.8),
    "MoveToDump": ("carrying recycled ~dist_dump !at_dump", "-dist_dump +at_dump", 0.05),
    "Dump": ("carrying recycled at_dump", "-carrying -recycled -garbage_found", 0.8),
}
SETTINGS = NetworkSettings(max_parallel=1)


def condition(word):
    if word.startswith("~"):
        return Condition(word[1:], Linear(0.0, 1.0))
    return Condition(word.removeprefix("!"), Boolean(not word.startswith("!")))


def effect(word):
    return Effect(word[1:], 1.0 if word.startswith("+") else -1.0)


def avoid(**settings):
    wish = Optional(Condition("rep_len", Linear(0.0, 1.5)))
    return Behaviour("Avoid", (condition("rep_bool"), wish), (effect("-rep_len"), effect("-rep_bool")), **settings)


def cleaning_model(settings=SETTINGS, extra=()):
    tasks = [
        Behaviour(name, tuple(map(condition, needs.split())), tuple(map(effect, does.split())), ready_threshold=ready)
        for name, (needs, does, ready) in TASKS.items()
    ]
    goals = [
        Goal("PatrolEnvironment", (condition("patrolled"),)),
        Goal("GarbageCleaned", (condition("!garbage_found"),)),
        Goal("AvoidCollision", (Negation(condition("rep_bool")),)),
    ]
    return NetworkModel(SENSORS, (*tasks, avoid(), *extra), goals, settings)


def wandering(rng, steps, rows):
    """Readings (T, R, S) in which now and then a sensor changes."""
    facts = rng.random((rows, len(FACTS))) < 0.4
    numbers = rng.uniform(0.0, 6.0, (rows, len(NUMBERS)))
    readings = np.empty((steps, rows, len(SENSORS)))
    for step in range(steps):
        facts = facts ^ (rng.random(facts.shape) < 0.05)
        facts[:, FACTS.index("patrolled")] = False
        numbers = np.clip(numbers + rng.normal(0.0, 0.2, numbers.shape), 0.0, 8.0)
        readings[step] = np.hstack([facts, numbers])
    return readings
