"""Golden descriptions of activators, conditions, behaviours and goals as objects of `selforg.network`."""

import warnings
from typing import Any

from selforg.network.model.activators import Activator, Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor, Weights
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Negation, Optional, Tree, leaves
from selforg.network.model.model import NetworkModel

CODES: dict[str, float] = {}  # texts as numbers: the network knows no other readings


def activator(given: dict[str, Any]) -> Activator:
    """Return one of our activators for one of the original's."""
    limits = {"low": float(given.get("minActivation", 0.0)), "high": float(given.get("maxActivation", 1.0))}
    match given["type"]:
        case "Boolean":
            return Boolean(given.get("desiredValue", True), **limits)
        case "Threshold":
            value_range = given.get("valueRange") or 0.0
            return Threshold(given["thresholdValue"], given.get("isMinimum", True), value_range, **limits)
        case "Linear":
            return Linear(given["zeroActivationValue"], given["fullActivationValue"], **limits)
        case "Greedy":
            return Greedy(given.get("maximize", True), given.get("step_size", 1.0), **limits)
        case "Equal":
            return Equal(number(given["desiredValue"]), **limits)
    raise ValueError(f"unknown activator {given['type']!r}")


def number(value: Any) -> float:
    """Return a reading or wanted value as a number; every text stands for one."""
    return CODES.setdefault(value, 1e6 + len(CODES)) if isinstance(value, str) else float(value)


def tree(given: dict[str, Any]) -> Tree:
    """Return a condition tree."""
    match given["kind"]:
        case "condition":
            return Condition(given["sensor"], activator(given["activator"]))
        case "negation":
            return Negation(tree(given["of"][0]))
        case "conjunction":
            return Conjunction(*map(tree, given["of"]))
        case "disjunction":
            return Disjunction(*map(tree, given["of"]))
    raise ValueError(f"unknown condition {given['kind']!r}")


def is_boolean(condition: Condition) -> bool:
    """Tell whether a condition looks at a fact."""
    return isinstance(condition.activator, Boolean)


def sensors_of_texts(tree: Tree) -> set[str]:
    """Return the sensors that a tree only compares for equality, so that they may read texts."""
    looks = [leaf.condition for leaf in leaves(tree)]
    return {c.sensor for c in looks} - {c.sensor for c in looks if not isinstance(c.activator, Equal)}


def precondition(given: dict[str, Any]) -> Tree | Optional:
    """Return a precondition, which may be optional."""
    return Optional(tree(given)) if given.get("optional") else tree(given)


def sensor(name: str, initial: Any) -> Sensor:
    """Return a sensor, whose initial reading says what it reads."""
    return Sensor(name, "fact" if isinstance(initial, bool) else "number")


def behaviour(given: dict[str, Any]) -> Behaviour:
    """Return a behaviour."""
    timeout = given["executionTimeout"]
    return Behaviour(
        given["name"],
        tuple(map(precondition, given["preconditions"])),
        tuple(Effect(effect["sensor"], effect["indicator"]) for effect in given["effects"]),
        given["readyThreshold"],
        given["priority"],
        given["interruptable"],
        None if timeout < 0 else timeout,
        planner_independent=given["independentFromPlanner"],
    )


def goal(given: dict[str, Any]) -> Goal:
    """Return a goal."""
    conditions = tuple(map(tree, given["conditions"]))
    return Goal(given["name"], conditions, given["priority"], given["permanent"], given["satisfaction_threshold"])


def settings(inputs: dict[str, Any]) -> NetworkSettings:
    """Return the settings of a network case."""
    config, manager = inputs["config"], inputs["manager"]
    biases = ("situationBias", "goalBias", "conflictorBias", "predecessorBias", "successorBias", "planBias")
    return NetworkSettings(
        inputs["algorithm"],
        Weights(*(config[bias] for bias in biases)),
        config["activationDecay"],
        manager["activationThreshold"],
        config["activationThresholdDecay"],
        manager["max_parallel_behaviours"],
        config["activationGoalPriority"],
    )


def model(inputs: dict[str, Any]) -> NetworkModel:
    """Return the model of a network case."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*larger than 1")  # matched here (Q17)
        return NetworkModel(
            [sensor(name, initial) for name, initial in inputs["sensors"]],
            list(map(behaviour, inputs["behaviours"])),
            list(map(goal, inputs["goals"])),
            settings(inputs),
        )
