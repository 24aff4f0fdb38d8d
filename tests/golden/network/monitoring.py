"""Replays monitoring.json: a planner that always answers the same plan, and what asks for a new one."""

from typing import Any

import numpy as np

from selforg.network import state as st
from selforg.network.model.activators import Boolean, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition, Optional
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from tests.golden.case import Case, SetAside, difference
from tests.golden.network.traces import RecordedPlanner

ROW = np.array([0])


def replay(case: Case) -> str | None:
    """Return how the replay differs from the original, None if it agrees."""
    model = model_of(case.inputs)
    planner = RecordedPlanner(len(model.goals))
    planner.answer = [model.behaviour_index[name] for name in case.inputs["plan"]]
    network = BehaviourNetwork(model, 1, planner)
    endings = case.inputs.get("fins") or [[]] * len(case.inputs["steps"])
    for number, expected in enumerate(case.expected["steps"]):
        if expected is None:  # Q19: the original raised, nothing is recorded beyond
            return None
        network.read(case.inputs["steps"][number])
        for name in endings[number]:
            network.finish(ROW, model.behaviour_index[name])
        calls = planner.calls
        network.step()
        wrong = difference(expected, whole_step(network, planner.calls - calls), f"step {number}")
        if wrong:
            limit = model.settings.max_parallel
            if limit is not None and len(expected["running"]) > limit:
                raise SetAside("M4")
            return wrong
    return None


def whole_step(network: BehaviourNetwork, calls: int) -> dict[str, Any]:
    """Return everything that is recorded of a step, as the network sees it."""
    names = [behaviour.name for behaviour in network.model.behaviours]
    return {
        "threshold": float(network.state.row_values[0, st.THRESHOLD]),
        "running": [name for name, on in zip(names, network.executing[0], strict=True) if on],
        "planner_calls": calls,
        "plan_index": int(network.state.plan_marks[0, st.PLAN_INDEX]),
        "activation": network.state.values[0, st.ACTIVATION].tolist(),
    }


def model_of(inputs: dict[str, Any]) -> NetworkModel:
    """Return the model of a case."""
    sensors = [*(Sensor(name, "fact") for name in inputs["facts"]), *(Sensor(name) for name in inputs["nums"])]
    goals = [
        Goal(given["name"], tuple(map(condition, given["cond"])), given.get("prio", 0), given["permanent"])
        for given in inputs["goals"]
    ]
    given = inputs["settings"]
    settings = NetworkSettings(
        activation_threshold=given["activation_threshold"],
        threshold_decay=given["threshold_decay"],
        activation_decay=given["activation_decay"],
        max_parallel=inputs["maxp"],
    )
    return NetworkModel(sensors, list(map(behaviour, inputs["behaviours"])), goals, settings)


def behaviour(given: dict[str, Any]) -> Behaviour:
    """Return a behaviour."""
    timeout = given.get("timeout", -1)
    return Behaviour(
        given["name"],
        tuple(Optional(condition(pre)) if pre["optional"] else condition(pre) for pre in given["pre"]),
        tuple(Effect(sensor, change) for sensor, change in given["eff"]),
        given["ready"],
        given.get("prio", 0),
        given.get("inter", True),
        None if timeout < 0 else timeout,
        planner_independent=given.get("indep", False),
    )


def condition(given: dict[str, Any]) -> Condition:
    """Return a condition."""
    match given["act"]:
        case "bool":
            return Condition(given["sensor"], Boolean(given["desired"]))
        case "lin":
            return Condition(given["sensor"], Linear(given["zero"], given["full"]))
        case "thr":
            return Condition(given["sensor"], Threshold(given["zero"], given["minimum"], given["rng"]))
    raise ValueError(f"unknown activator {given['act']!r}")
