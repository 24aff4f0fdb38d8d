"""Replays conditions.json: single activators and condition trees, as the goal of a network without behaviours."""

from typing import Any

from selforg.network.model.behaviours import Goal, Sensor
from selforg.network.model.conditions import leaves
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.step.readings import ReadingError
from tests.golden.case import Case, SetAside, difference
from tests.golden.network import parts
from tests.golden.network.wishes import goal_wishes

ERRORS = {"activation_error", "satisfaction_error", "wish_error", "wishes_error"}


def replay(case: Case) -> str | None:
    """Return how the replay differs from the original, None if it agrees."""
    return replay_activator(case) if "activator" in case.inputs else replay_tree(case)


def replay_activator(case: Case) -> str | None:
    """Replay readings of one activator."""
    given = {"kind": "condition", "sensor": "x", "activator": case.inputs["activator"]}
    results = case.expected.get("results", [])
    if "error" in case.expected or all(result.keys() <= ERRORS for result in results):
        return expect_refusal(given)
    expected, direction = case.expected["results"], parts.activator(case.inputs["activator"]).direction
    network = network_for(given)
    for value, wanted in zip(case.inputs["values"], expected, strict=True):
        got = evaluate(network, {"x": value})
        wrong = compare(wanted, got and {"activation": got[0], "wish": got[1][0][1]})
        if wrong:
            return f"reading {value}: {wrong}"
    return difference(case.expected["direction"], direction, "direction")


def replay_tree(case: Case) -> str | None:
    """Replay readings of a condition tree."""
    network = network_for(case.inputs["condition"])
    for step, wanted in enumerate(case.expected["steps"]):
        got = evaluate(network, case.inputs["steps"][step])
        wrong = compare(wanted, got and {"satisfaction": got[0], "wishes": got[1]})
        if wrong:
            return f"step {step}: {wrong}"
    return None


def expect_refusal(given: dict[str, Any]) -> str | None:
    """Return None if a description that the original refuses, at once or at every reading, is refused."""
    try:
        parts.tree(given)
    except ValueError:
        return None
    return "accepted what the original refuses"


def network_for(given: dict[str, Any]) -> BehaviourNetwork:
    """Return a network of one row whose goal is the condition."""
    tree = parts.tree(given)
    kinds = {leaf.condition.sensor: "number" for leaf in leaves(tree)}
    kinds |= {leaf.condition.sensor: "fact" for leaf in leaves(tree) if parts.is_boolean(leaf.condition)}
    sensors = [Sensor(name, kind) for name, kind in kinds.items()]
    return BehaviourNetwork(NetworkModel(sensors, (), [Goal("it", (tree,))]), 1)


def evaluate(network: BehaviourNetwork, values: dict[str, Any]) -> tuple[float, list[list[Any]]] | None:
    """Return satisfaction and sorted wishes at these readings, None if they are refused."""
    texts = parts.sensors_of_texts(network.model.goals[0].conditions[0])
    try:
        network.read({name: parts.number(v) if name in texts else v for name, v in values.items()})
    except ReadingError:
        return None
    network.step()
    return float(network.state.goal_satisfaction[0, 0]), sorted(map(list, goal_wishes(network, 0, "it")))


def compare(wanted: dict[str, Any], got: dict[str, Any] | None) -> str | None:
    """Compare one evaluation; readings that we refuse and the original takes for unsatisfied are Q33."""
    if got is None:
        if wanted.keys() <= ERRORS:
            return None
        if wanted.keys() & ERRORS:
            raise SetAside("Q33")
        return f"refused, expected {wanted}"
    return difference(wanted, got)
