import numpy as np
import pytest

from selforg.network import state as st
from selforg.network.explanation import explain, in_short
from selforg.network.model.activators import Boolean, Greedy, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, Interface, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition, Conjunction, Negation, Optional
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from tests.selforg.network.cleaning import cleaning_model, wandering
from tests.selforg.network.random_models import Draw

ROW = np.array([0])
IS = Condition("fact", Boolean())
STEADY = NetworkSettings(activation_threshold=0.5, threshold_decay=1.0)


def explained(*behaviours, settings=STEADY, goals=()):
    model = NetworkModel([Sensor("fact", "fact"), Sensor("other")], behaviours, goals, settings)
    return BehaviourNetwork(model, 1, explained=True)


def told(network, times=1, **readings):
    """The reason of every behaviour after the step."""
    network.read(readings)
    for _ in range(times):
        network.step()
    account = explain(network, 0)
    return {behaviour.name: behaviour.why for behaviour in account.behaviours}


def test_start_and_stop_of_one_behaviour():
    network = explained(Behaviour("go", (IS,), timeout=2))
    assert told(network) == {"go": "does not start: not ready"}
    assert told(network, fact=True) == {"go": "started: ready and active enough"}
    assert told(network) == {"go": "keeps running: ready and active enough"}
    assert told(network, fact=False) == {"go": "stopped: no longer ready"}
    assert told(network, 4, fact=True) == {"go": "stopped: its time is up"}
    network.enable(ROW, 0, False)
    assert told(network) == {"go": "takes no turn: it corrects what the others command"}
    network.start_by_hand(ROW, 0, True)
    assert told(network) == {"go": "started by hand"}
    assert told(network) == {"go": "keeps running: started by hand"}


WEAK = Behaviour("weak", (), (Effect("other", 1.0),))
STRONG = Behaviour("strong", (IS,), (Effect("other", -1.0),), priority=1)


@pytest.mark.parametrize(
    ("behaviours", "settings", "course"),
    [
        (
            [Behaviour("go")],
            NetworkSettings(activation_threshold=5.0, threshold_decay=0.9),
            [({}, {"go": "does not start: activation below the threshold"})],
        ),
        (  # starting raises the threshold
            [Behaviour("go", timeout=None), Behaviour("other", (IS,))],
            NetworkSettings(activation_threshold=0.9, threshold_decay=0.4, activation_decay=0.1),
            [({}, {}), ({}, {"go": "stopped: activation fell below the threshold"})],
        ),
        (
            [WEAK, STRONG],
            STEADY,
            [
                ({}, {}),
                ({"fact": True}, {"weak": "stopped: had to make room for strong"}),
                (
                    {},
                    {
                        "weak": "does not start: strong influences the same sensor and does not yield",
                        "strong": "keeps running: ready and active enough",
                    },
                ),
            ],
        ),
        (
            [Behaviour("late", (IS,)), Behaviour("early", interruptable=False)],
            NetworkSettings(activation_threshold=0.5, threshold_decay=1.0, max_parallel=1),
            [
                ({}, {}),
                ({"fact": True},
                 {"late": "does not start: enough others run", "early": "keeps running: not interruptable"}),
            ],
        ),
    ],
)  # fmt: skip
def test_reasons_of_the_threshold_the_others_and_a_full_network(behaviours, settings, course):
    network = explained(*behaviours, settings=settings)
    for readings, reasons in course:
        assert reasons.items() <= told(network, **readings).items()


@pytest.mark.parametrize("seed", range(15))
def test_reasons_agree_with_what_happened(seed):
    draw = Draw(np.random.default_rng(seed))
    model, guarantee = draw.model(), draw.chance(0.3)
    network, silent = BehaviourNetwork(model, 1, explained=True), BehaviourNetwork(model, 1)
    readings = {sensor.name: 0.0 for sensor in draw.sensors}
    for _ in range(40):
        readings = draw.readings(readings)
        for each in (network, silent):
            each.readings[0] = [readings[sensor.name] for sensor in model.sensors]
            each.step(guarantee=guarantee)
        marks = network.state.marks[0]
        np.testing.assert_array_equal(marks[: st.MARK_LAYERS], silent.state.marks[0])
        np.testing.assert_array_equal(network.state.values, silent.state.values)
        reason, by = marks[st.REASON], marks[st.BY]
        runs, started, stopped = marks[st.EXECUTING] == 1, marks[st.STARTED] == 1, marks[st.STOPPED] == 1
        np.testing.assert_array_equal(started, reason == st.STARTED_READY)
        np.testing.assert_array_equal(runs & ~started, (reason >= st.KEPT_READY) & (reason <= st.KEPT_STUBBORN))
        had_to_stop = (reason >= st.OUT_OF_TIME) & (reason <= st.DISPLACED)
        assert (had_to_stop == (stopped & ~started))[reason != st.DISPLACED].all()
        assert not runs[had_to_stop].any()  # the displaced ones may have been started in this very step
        np.testing.assert_array_equal(by >= 0, (reason == st.DISPLACED) | (reason == st.BLOCKED))
        assert (marks[st.READY][reason == st.NOT_READY] == 0).all()


def test_every_reason_has_words():
    assert sorted(st.WORDS) == list(range(st.UNKNOWN, st.NO_PLACE + 1))


def test_an_explanation_adds_up():
    model = cleaning_model()
    network = BehaviourNetwork(model, 3, Planner(model), explained=True)
    decay, before = model.settings.activation_decay, explain(network, 2)
    for readings in wandering(np.random.default_rng(0), 15, 3):
        network.readings[:] = readings
        network.step()
        old, account = {b.name: b.activation for b in before.behaviours}, explain(network, 2)
        assert account.total == pytest.approx(sum(old.values()) or 1.0)
        for behaviour in account.behaviours:
            got = decay * old[behaviour.name] + sum(behaviour.components.values())
            assert behaviour.activation == pytest.approx(max(0.0, got))
        before = account


def test_conditions_show_what_is_held_and_what_is_optional():
    faces = Interface((Negation(Conjunction(IS, IS)),)), Interface((IS,))
    wish = Optional(Condition("other", Threshold(2.0)))
    network = explained(Behaviour("either", (wish,), alternatives=faces), goals=(Goal("g", (IS,), permanent=False),))
    network.read({"fact": True, "other": 1.5})
    network.step()
    account = explain(network, 0)
    optional, held = account.behaviours[0].conditions
    label = "optional: other = 1.5, Threshold(threshold=2.0, minimum=True, value_range=0.0)"
    assert (optional.label, optional.satisfaction) == (label, 0.0)
    assert (held.label, held.satisfaction) == ("Negation", 0.0)
    assert [part.label for part in held.parts] == ["Conjunction"]
    assert [part.satisfaction for part in held.parts[0].parts] == [1.0, 1.0]
    assert account.goals[0].enabled is False
    assert account.plan is None
    network.hold(ROW, 0, 1)
    network.step()
    assert [c.label for c in explain(network, 0).behaviours[0].conditions][1] == ("fact = 1, Boolean(desired=True)")


def test_activators_in_short():
    assert in_short(Greedy(low=0.2)) == "Greedy(low=0.2, maximise=True, step_size=1.0)"
