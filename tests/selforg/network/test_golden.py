"""The replay of the original's recorded traces would notice a difference."""

from copy import deepcopy

import pytest

from tests.golden.__main__ import PARTS
from tests.golden.case import read_case
from tests.golden.network import traces
from tests.golden.runner import entries_of


@pytest.fixture(scope="module")
def recorded():
    """The record of a trace with a planner, which is matched."""
    entries = entries_of(PARTS[0] / "network.json.xz")
    entry = next(entry for entry in entries if entry["tag"] == "stub plan, planBias 0.5")
    assert traces.replay(read_case(entry)) is None
    return entry


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
