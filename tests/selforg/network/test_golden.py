"""The replay of the original's recorded traces would notice a difference."""

from copy import deepcopy

import pytest

from tests.golden.__main__ import PARTS
from tests.golden.case import SetAside, read_case
from tests.golden.network import conditions, traces
from tests.golden.runner import entries_of


@pytest.fixture(scope="module")
def recorded():
    """The record of a trace with a planner, which is matched."""
    entries = entries_of(PARTS[0] / "network.json.xz")
    entry = next(entry for entry in entries if entry["tag"] == "stub plan, planBias 0.5")
    assert traces.replay(read_case(entry)) is None
    return entry


def case(inputs, expected, group="group"):
    return read_case({"id": "c", "group": group, "inputs": inputs, "expected": expected})


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("threshold",), 1.0),
        (("plan_index",), 3),
        (("planner_calls",), 2),
        (("running",), ["nobody"]),
        (("behaviours", "first", "components", "successors"), 0.123),
        (("behaviours", "first", "wishes"), [["x", 1.0]]),
        (("goals", "goal", "satisfaction"), 0.5),
    ],
)
def test_a_changed_record_is_noticed(recorded, path, value):
    entry = deepcopy(recorded)
    step = entry["expected"]["steps"][4]
    path = tuple(next(iter(step["goals"])) if key == "goal" else key for key in path)
    for key in path[:-1]:
        step = step[key]
    assert step[path[-1]] != value
    step[path[-1]] = value
    assert path[-1] in traces.replay(read_case(entry))


def test_a_wrongly_typed_reading_is_set_aside_by_its_number():
    inputs = {"condition": {"kind": "condition", "sensor": "s", "activator": {"type": "Boolean"}}, "steps": [{"s": 1}]}
    with pytest.raises(SetAside, match="Q33"):
        conditions.replay(case(inputs, {"steps": [{"satisfaction": 0.0, "wishes_error": "AssertionError"}]}))
    assert "refused" in conditions.replay(case(inputs, {"steps": [{"satisfaction": 0.0, "wishes": []}]}))


def test_texts_may_be_compared_for_equality_only():
    results = [{"activation": 1.0, "wish": 0}, {"activation": 0.0, "wish": 1}]
    inputs = {"activator": {"type": "Equal", "desiredValue": "red"}, "values": ["red", "blue"]}
    assert conditions.replay(case(inputs, {"direction": 1, "results": results})) is None
    assert "activation" in conditions.replay(case(inputs, {"direction": 1, "results": results[::-1]}))
    inputs = {"activator": {"type": "Threshold", "thresholdValue": 1.0}, "values": ["red"]}
    assert "refused" in conditions.replay(case(inputs, {"direction": 1, "results": results[:1]}))


def test_what_the_original_refuses_must_be_refused():
    flat = {"type": "Linear", "zeroActivationValue": 1.0, "fullActivationValue": 1.0}
    inputs = {"activator": flat, "values": []}
    assert conditions.replay(case(inputs, {"error": "ValueError"})) is None
    inputs = {"activator": {**flat, "fullActivationValue": 2.0}, "values": []}
    assert "accepted" in conditions.replay(case(inputs, {"error": "ValueError"}))
