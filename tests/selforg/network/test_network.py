"""Readings that are refused, and behaviours that clash; all other rules: `test_reference.py` and the golden traces."""

import numpy as np
import pytest

from selforg.network.model.activators import Boolean, Linear
from selforg.network.model.behaviours import Behaviour, Effect, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.step.readings import ReadingError

FACT, NUMBER = Sensor("fact", "fact"), Sensor("number")
IS = Condition("fact", Boolean())
EAGER = NetworkSettings(activation_threshold=0.5)
STEADY = NetworkSettings(activation_threshold=0.5, threshold_decay=1.0)


def network_of(*behaviours, goals=(), settings=EAGER, rows=1):
    return BehaviourNetwork(NetworkModel([FACT, NUMBER, Sensor("other")], behaviours, goals, settings), rows)


def stepped(network, times=1, guarantee=False, **readings):
    network.read(readings)
    for _ in range(times):
        network.step(guarantee=guarantee)
    return network


def running(network):
    return [b.name for b, on in zip(network.model.behaviours, network.executing[0], strict=True) if on]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"fact": 1}, "sensor 'fact': expected True or False, got 1"),
        ({"fact": None}, "sensor 'fact': expected True or False, got None"),
        ({"number": "far"}, "sensor 'number': expected a number, got 'far'"),
        ({"number": float("nan")}, "sensor 'number': expected a number, got nan"),
        ({"facts": True}, r"reading: unknown sensor 'facts' \(known: fact, number, other\)"),
    ],
)
def test_a_wrong_reading_is_refused(values, message):
    with pytest.raises(ValueError if "facts" in values else ReadingError, match=message):
        network_of().read(values)


def test_a_number_takes_a_truth_value():
    network = network_of()
    network.read({"number": np.True_, "other": True})
    np.testing.assert_array_equal(network.readings, [[0.0, 1.0, 1.0]])


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        (0, 0.5, r"row 2: sensor 'fact': expected 0 or 1 \(it is a fact\), got 0.5"),
        (1, np.nan, "row 2: sensor 'number'"),
    ],
)
def test_a_wrong_reading_stops_the_step_before_anything_has_changed(column, value, message):
    network = network_of(Behaviour("go"), rows=3)
    before = network.state.values.copy(), network.state.marks.copy()
    network.readings[2, column] = value
    with pytest.raises(ReadingError, match=message):
        network.step()
    np.testing.assert_array_equal(network.state.values, before[0])
    np.testing.assert_array_equal(network.state.marks, before[1])
    network.step(np.array([0, 1]))  # the rows that read well go on


def clashing(old, new, **more):
    """Two behaviours that influence one sensor: the one runs from the start, the other can when a number is 1."""
    return (
        Behaviour("old", (), (Effect("other", 1.0),), priority=old, **more),
        Behaviour("new", (Condition("number", Linear(0.0, 1.0)),), (Effect("other", -1.0),), priority=new),
    )


def three(**more):
    """Two behaviours, and one that influences what both do."""
    return (
        Behaviour("one", (), (Effect("number", 1.0),)),
        Behaviour("two", (), (Effect("other", 1.0),), **more),
        Behaviour("both", (IS,), (Effect("number", 1.0), Effect("other", 1.0)), priority=1),
    )


TIMED = Behaviour("short", timeout=2), Behaviour("stubborn", timeout=2, interruptable=False)


@pytest.mark.parametrize(
    ("behaviours", "course"),
    [
        # of two behaviours on one sensor that of the higher priority runs, else the one that does already
        (clashing(0, 1), [(3, {}, ["old"]), (1, {"number": 1.0}, ["new"])]),
        (clashing(1, 0), [(3, {}, ["old"]), (1, {"number": 1.0}, ["old"])]),
        (clashing(0, 0), [(3, {}, ["old"]), (1, {"number": 1.0}, ["old"])]),
        (clashing(0, 1, interruptable=False), [(3, {}, ["old"]), (1, {"number": 1.0}, ["old"])]),
        # all that clash make room or none does; the original trips over an assertion here (Q19)
        (three(), [(2, {}, ["one", "two"]), (1, {"fact": True}, ["both"])]),
        (three(interruptable=False), [(2, {}, ["one", "two"]), (1, {"fact": True}, ["one", "two"])]),
        # a timeout stops what is interruptable
        (TIMED, [*[(1, {}, ["short", "stubborn"])] * 3, (1, {}, ["stubborn"])]),
    ],
)
def test_what_runs(behaviours, course):
    network = network_of(*behaviours, settings=STEADY)
    for times, readings, runs in course:
        assert running(stepped(network, times, **readings)) == runs
