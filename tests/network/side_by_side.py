"""The compiled network and the naive one live the same life; any difference is told."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from selforg.network import state as st
from selforg.network.inspection import behaviour_wishes, goal_wishes
from selforg.network.network import BehaviourNetwork
from tests.network.random_models import Draw
from tests.network.reference import Node, ReferenceNetwork

TOLERANCE = 1e-9
ROUNDING = 1e-12
ROW = np.array([0])


def apply_compiled(network: BehaviourNetwork, kind: str, whom: str, value: Any) -> None:
    model = network.model
    if kind == "plan":
        names, index = value
        network.set_plan(0, [model.behaviour_index[name] for name in names], index)
    elif kind == "goal_enable":
        network.enable_goal(ROW, model.goal_index[whom], value)
    else:
        behaviour = model.behaviour_index[whom]
        match kind:
            case "finish":
                network.finish(ROW, behaviour)
            case "enable":
                network.enable(ROW, behaviour, value)
            case "priority":
                network.set_priority(ROW, behaviour, value)
            case "manual_start":
                network.start_by_hand(ROW, behaviour, value)
            case "hold":
                network.hold(ROW, behaviour, value)
            case "remove":
                network.remove(ROW, behaviour)


def apply_naive(network: ReferenceNetwork, kind: str, whom: str, value: Any) -> None:
    match kind:
        case "plan":
            network.plan, network.plan_index = value
        case "goal_enable":
            network.goal_enabled[whom] = value
        case "finish":
            network.finish(whom)
        case "enable":
            network.enable(whom, value)
        case "priority":
            network.nodes[whom].priority = value
        case "manual_start":
            network.nodes[whom].manual = value
        case "hold":
            network.nodes[whom].alternative = value
        case "remove":
            network.remove(whom)


def first_difference(seed: int, steps: int) -> str | None:
    """One random network, one random life of `steps` steps; where the two first differ."""
    draw = Draw(np.random.default_rng(seed))
    model = draw.model()
    compiled, naive = BehaviourNetwork(model, 1), ReferenceNetwork(model)
    guarantee = draw.chance(0.2)
    readings = {sensor.name: 0.0 for sensor in draw.sensors}
    for step in range(steps):
        readings = draw.readings(readings)
        for kind, whom, value in draw.events(model):
            apply_compiled(compiled, kind, whom, value)
            apply_naive(naive, kind, whom, value)
        compiled.readings[0] = [readings[sensor.name] for sensor in model.sensors]
        compiled.step(guarantee=guarantee)
        naive.step(readings, guarantee)
        if 0.0 < min(compiled.state.row_values[st.TOTAL, 0], naive.total) < ROUNDING:
            return None  # activations that cancel: whether their sum is 0 (and counts as 1) is the order of summation's
        for what, ours, theirs in pairs(compiled, naive):
            if not math.isclose(ours, theirs, rel_tol=TOLERANCE, abs_tol=TOLERANCE):
                return f"seed {seed}, step {step}: {what}: compiled {ours}, naive {theirs}"
    return None


def pairs(compiled: BehaviourNetwork, naive: ReferenceNetwork) -> Iterator[tuple[str, Any, Any]]:
    """Everything both know, by name."""
    state = compiled.state
    yield "threshold", state.row_values[st.THRESHOLD, 0], naive.threshold
    yield "total activation", state.row_values[st.TOTAL, 0], naive.total
    for b, (name, node) in enumerate(naive.nodes.items()):
        if node.present:
            for what, ours, theirs in of_behaviour(compiled, b, name, node):
                yield f"{name} {what}", ours, theirs
    for g, name in enumerate(naive.goal_enabled):
        yield f"{name} enabled", state.goal_enabled[0, g], naive.goal_enabled[name]
        yield f"{name} satisfaction", state.goal_satisfaction[0, g], naive.goal_satisfaction[name]
        yield from wishes(name, goal_wishes(compiled, 0, name), naive.goal_wishes[name])


def of_behaviour(compiled: BehaviourNetwork, b: int, name: str, node: Node) -> Iterator[tuple[str, Any, Any]]:
    values, marks = compiled.state.values[:, 0, b], compiled.state.marks[:, 0, b]
    for what, mark, theirs in (
        ("executing", st.EXECUTING, node.executing),
        ("started", st.STARTED, node.started),
        ("stopped", st.STOPPED, node.stopped),
        ("ready", st.READY, node.ready),
        ("time", st.EXECUTION_TIME, node.time),
    ):
        yield what, marks[mark], theirs
    yield "satisfaction", values[st.SATISFACTION], node.satisfaction
    for component, layer in st.COMPONENTS.items():
        yield component, values[layer], node.components[component]
    yield "activation", values[st.ACTIVATION], node.activation
    yield from wishes(name, behaviour_wishes(compiled, 0, name), node.wishes)


def wishes(name: str, ours: list[tuple[str, float]], theirs: list[tuple[str, float]]) -> Iterator[tuple[str, Any, Any]]:
    ours, theirs = sorted(ours), sorted(theirs)
    yield f"{name} wishes about {[s for s, _ in ours]} and {[s for s, _ in theirs]}", len(ours), len(theirs)
    for (sensor, one), (other_sensor, other) in zip(ours, theirs, strict=True):
        yield f"{name} wish about {sensor} and {other_sensor}", sensor == other_sensor, True
        yield f"{name} wish about {sensor}", one, other
