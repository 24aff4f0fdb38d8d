"""The compiled network and the naive one live the same life; any difference is told."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from selforg.network import state as st
from selforg.network.network import BehaviourNetwork
from tests.golden.network.wishes import behaviour_wishes, goal_wishes
from tests.selforg.network.random_models import Draw
from tests.selforg.network.reference import Node, ReferenceNetwork

TOLERANCE = 1e-9
ROUNDING = 1e-12
ROW = np.array([0])


def apply(compiled: BehaviourNetwork, naive: ReferenceNetwork, kind: str, whom: str, values: tuple[Any, ...]) -> None:
    """Let an event happen to both networks: a method of their own, or a plan that they are given."""
    model = compiled.model
    if kind == "set_plan":
        naive.plan, naive.plan_index = values
        compiled.set_plan(0, [model.behaviour_index[name] for name in naive.plan], naive.plan_index)
    else:
        number = model.goal_index[whom] if kind == "enable_goal" else model.behaviour_index[whom]
        getattr(compiled, kind)(ROW, number, *values)
        getattr(naive, kind)(whom, *values)


def live(seed: int, steps: int) -> tuple[str | None, int]:
    """Where the two first differ, and how many steps were compared: a life ends where rounding has to decide."""
    draw = Draw(np.random.default_rng(seed))
    model = draw.model()
    compiled, naive = BehaviourNetwork(model, 1), ReferenceNetwork(model)
    guarantee = draw.chance(0.2)
    readings = {sensor.name: 0.0 for sensor in draw.sensors}
    for step in range(steps):
        readings = draw.readings(readings)
        for event in draw.events(model):
            apply(compiled, naive, *event)
        compiled.readings[0] = [readings[sensor.name] for sensor in model.sensors]
        compiled.step(guarantee=guarantee)
        naive.step(readings, guarantee)
        if 0.0 < min(compiled.state.row_values[0, st.TOTAL], naive.total) < ROUNDING:
            return None, step  # activations that cancel: the order of summation says whether their sum is 0
        told = differing(numbers(compiled, naive))
        if told is None and ordered_by_rounding(compiled, naive):
            return None, step
        told = told or differing(decisions(compiled, naive))
        if told:
            return f"seed {seed}, step {step}: {told}", step
    return None, steps


def differing(pairs: Iterator[tuple[str, Any, Any]]) -> str | None:
    """The first pair that is not equal to 1e-9."""
    for what, ours, theirs in pairs:
        if not math.isclose(ours, theirs, rel_tol=TOLERANCE, abs_tol=TOLERANCE):
            return f"{what}: compiled {ours}, naive {theirs}"
    return None


def ordered_by_rounding(compiled: BehaviourNetwork, naive: ReferenceNetwork) -> bool:
    """Whether equal activations (to 1e-9), or one and the threshold, come in another order in one of the two."""
    present = [b for b, node in enumerate(naive.nodes.values()) if node.present]
    theirs = [*(node.activation for node in naive.nodes.values() if node.present), *naive.thresholds]
    thresholds = compiled_thresholds(compiled, naive)
    ours = [*compiled.state.values[0, st.ACTIVATION, present].tolist(), *thresholds]
    return any(
        (theirs[i] > theirs[j]) != (ours[i] > ours[j]) or (theirs[i] < theirs[j]) != (ours[i] < ours[j])
        for i in range(len(present))
        for j in range(len(ours))
    )


def compiled_thresholds(compiled: BehaviourNetwork, naive: ReferenceNetwork) -> list[float]:
    """The thresholds that the compiled step went through: as many as the naive one, the last one known."""
    last, decay = float(compiled.state.row_values[0, st.DECIDING]), compiled.model.settings.threshold_decay
    thresholds = [last]
    for _ in naive.thresholds[1:]:
        thresholds.insert(0, thresholds[0] / decay)
    return thresholds


def numbers(compiled: BehaviourNetwork, naive: ReferenceNetwork) -> Iterator[tuple[str, Any, Any]]:
    """What the step computed before anything was decided, by name."""
    state = compiled.state
    yield "total activation", state.row_values[0, st.TOTAL], naive.total
    for b, (name, node) in enumerate(naive.nodes.items()):
        if not node.present:
            continue
        values = state.values[0, :, b]
        yield f"{name} ready", state.marks[0, st.READY, b], node.ready
        yield f"{name} satisfaction", values[st.SATISFACTION], node.satisfaction
        for component, layer in st.COMPONENTS.items():
            yield f"{name} {component}", values[layer], node.components[component]
        yield f"{name} activation", values[st.ACTIVATION], node.activation
        yield from wishes(name, behaviour_wishes(compiled, 0, name), node.wishes)
    for g, name in enumerate(naive.goal_enabled):
        yield f"{name} enabled", state.goal_enabled[0, g], naive.goal_enabled[name]
        yield f"{name} satisfaction", state.goal_satisfaction[0, g], naive.goal_satisfaction[name]
        yield from wishes(name, goal_wishes(compiled, 0, name), naive.goal_wishes[name])


def decisions(compiled: BehaviourNetwork, naive: ReferenceNetwork) -> Iterator[tuple[str, Any, Any]]:
    """What was decided, by name."""
    for b, (name, node) in enumerate(naive.nodes.items()):
        if node.present:
            yield from of_behaviour(compiled, b, name, node)
    yield "threshold", compiled.state.row_values[0, st.THRESHOLD], naive.threshold


def of_behaviour(compiled: BehaviourNetwork, b: int, name: str, node: Node) -> Iterator[tuple[str, Any, Any]]:
    marks = compiled.state.marks[0, :, b]
    for what, mark, theirs in (
        ("executing", st.EXECUTING, node.executing),
        ("started", st.STARTED, node.started),
        ("stopped", st.STOPPED, node.stopped),
        ("time", st.EXECUTION_TIME, node.time),
    ):
        yield f"{name} {what}", marks[mark], theirs


def wishes(name: str, ours: list[tuple[str, float]], theirs: list[tuple[str, float]]) -> Iterator[tuple[str, Any, Any]]:
    ours, theirs = sorted(ours), sorted(theirs)
    yield f"{name} wishes about {[s for s, _ in ours]} and {[s for s, _ in theirs]}", len(ours), len(theirs)
    for (sensor, one), (other_sensor, other) in zip(ours, theirs, strict=True):
        yield f"{name} wish about {sensor} and {other_sensor}", sensor == other_sensor, True
        yield f"{name} wish about {sensor}", one, other
