"""Single rules of a step, each on the smallest network that shows it."""

import numpy as np
import pytest

from selforg.network import state as st
from selforg.network.model.activators import Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, Interface, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition, Optional
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.step.readings import ReadingError
from tests.golden.network.wishes import behaviour_wishes, goal_wishes

ROW = np.array([0])
FACT, NUMBER = Sensor("fact", "fact"), Sensor("number")
IS, IS_NOT = Condition("fact", Boolean()), Condition("fact", Boolean(False))
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


def threshold(network):
    return network.state.row_values[0, st.THRESHOLD]


def activation(network, b=0):
    return network.state.values[0, st.ACTIVATION, b]


# readings


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


# conditions


def test_an_optional_precondition_only_adds_its_wishes():
    near = Optional(Condition("number", Threshold(2.0, value_range=4.0)))
    network = stepped(network_of(Behaviour("go", (IS, near))), fact=True)
    assert running(network) == ["go"]
    assert network.state.values[0, st.SATISFACTION, 0] == 1.0
    assert network.state.values[0, st.PRECONDITIONS, 0] == 1.0
    assert behaviour_wishes(network, 0, "go") == [("fact", 0.0), ("number", 0.5)]


def test_a_ready_behaviour_keeps_the_smallest_wish_about_a_sensor():
    trees = tuple(Optional(Condition("number", Threshold(level, value_range=10.0))) for level in (4.0, 2.0, 3.0))
    network = stepped(network_of(Behaviour("go", (IS, *trees))), fact=False)
    assert [wish for _, wish in behaviour_wishes(network, 0, "go")] == pytest.approx([1.0, 0.4, 0.2, 0.3])
    stepped(network, fact=True)
    assert behaviour_wishes(network, 0, "go") == [("fact", 0.0), ("number", pytest.approx(0.2))]


def test_a_satisfied_goal_switches_off_unless_it_is_permanent():
    goals = [Goal("stay", (IS,)), Goal("once", (IS,), permanent=False)]
    network = stepped(network_of(goals=goals), fact=True)
    stepped(network, fact=False)
    np.testing.assert_array_equal(network.state.goal_enabled, [[1, 0]])
    assert goal_wishes(network, 0, "stay") == [("fact", 1.0)]
    network.enable_goal(ROW, 1, True)
    stepped(network)
    np.testing.assert_array_equal(network.state.goal_enabled, [[1, 1]])


def test_equal_and_greedy():
    goals = [Goal("three", (Condition("number", Equal(3.0)),)), Goal("less", (Condition("other", Greedy(False)),))]
    network = stepped(network_of(goals=goals), number=3.0)
    np.testing.assert_array_equal(network.state.goal_satisfaction, [[1.0, 0.0]])
    assert goal_wishes(network, 0, "less") == [("other", -1.0)]


# arbitration


def test_a_behaviour_that_ends_itself_loses_its_activation_and_one_that_is_stopped_keeps_it():
    network = stepped(network_of(Behaviour("go", (IS,))), 3, fact=True)
    before = activation(network)
    stepped(network, fact=False)
    assert running(network) == []
    assert activation(network) == pytest.approx(0.9 * before)
    stepped(network, 6, fact=True)
    network.finish(ROW, 0)
    stepped(network)
    assert activation(network) == pytest.approx(1.0)  # what this step adds


def test_the_parallel_limit_counts_what_was_started_by_hand():
    settings = NetworkSettings(activation_threshold=0.5, threshold_decay=1.0, max_parallel=1)
    network = network_of(Behaviour("a"), Behaviour("b", (IS,)), settings=settings)
    network.start_by_hand(ROW, 1, True)
    assert running(stepped(network, 3)) == ["b"]
    network.remove(ROW, 1)  # what is no longer there takes no place
    assert running(stepped(network, 3)) == ["a"]


def test_what_was_started_by_hand_yields_to_nobody():
    weak = Behaviour("weak", (), (Effect("other", 1.0),))
    strong = Behaviour("strong", (IS,), (Effect("other", 1.0),), priority=5)
    network = network_of(weak, strong)
    network.start_by_hand(ROW, 0, True)
    assert running(stepped(network)) == ["weak"]
    assert running(stepped(network, 5, fact=True)) == ["weak"]
    network.start_by_hand(ROW, 0, False)
    assert running(stepped(network, 5)) == ["strong"]


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


def test_a_disabled_behaviour_stops_and_does_not_start():
    """In the original it could (Q16)."""
    network = stepped(network_of(Behaviour("go")))
    assert running(network) == ["go"]
    network.enable(ROW, 0, False)
    assert running(network) == []
    stepped(network, 20, guarantee=True)
    assert running(network) == []
    network.enable(ROW, 0, True)
    stepped(network, 20)
    assert running(network) == ["go"]


def test_the_threshold_falls_while_nothing_runs_and_rises_when_something_starts():
    network = network_of(Behaviour("go", (IS,)), settings=NetworkSettings())
    for step in range(1, 4):
        stepped(network)
        assert threshold(network) == pytest.approx(7.0 * 0.8**step)
    stepped(network, 3, fact=True)
    assert running(network) == ["go"]
    assert threshold(network) == pytest.approx(7.0 * 0.8**4)  # 1 and 1.9 are not enough, 2.71 is
    stepped(network, 1)
    assert threshold(network) == pytest.approx(7.0 * 0.8**4)


@pytest.mark.parametrize(
    ("decay", "fact", "runs"),
    [(0.8, True, ["go"]), (0.8, False, []), (1.0, True, [])],  # where the threshold does not fall it ends all the same
)
def test_the_guarantee_lets_something_run_at_once_if_anything_can(decay, fact, runs):
    settings = NetworkSettings(threshold_decay=decay)
    network = stepped(network_of(Behaviour("go", (IS,)), settings=settings), guarantee=True, fact=fact)
    assert running(network) == runs
    assert network.state.marks[0, st.EXECUTION_TIME, 0] == (0 if runs else -1)


def test_a_coordinator_shows_what_it_holds():
    faces = Interface((IS,), (Effect("number", 1.0),)), Interface((IS_NOT,), (Effect("other", 1.0),))
    network = network_of(Behaviour("either", alternatives=faces), rows=2)
    network.hold(np.array([1]), 0, 1)
    network.step()
    np.testing.assert_array_equal(network.state.marks[:, st.READY, 0], [0, 1])
    assert behaviour_wishes(network, 0, "either") == [("fact", 1.0)]
    assert behaviour_wishes(network, 1, "either") == [("fact", 0.0)]
