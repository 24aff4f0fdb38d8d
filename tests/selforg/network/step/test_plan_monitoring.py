"""How a plan is followed: when its step is passed, and when the planner is asked again."""

from dataclasses import replace

import numpy as np
import pytest

from selforg.network import state as st
from selforg.network.model.activators import Boolean, Linear
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition, Optional
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from tests.golden.network.traces import Forgetful
from tests.selforg.network.planning.test_planning import Counting

ROW = np.array([0])


def errand(effect=-1.0, **settings):
    """First fetch (far comes down by `effect`), then give; something else may happen to `noise`."""
    return NetworkModel(
        [Sensor("far"), Sensor("given", "fact"), Sensor("noise", "fact"), Sensor("unused", "fact")],
        [
            Behaviour("fetch", effects=(Effect("far", effect),)),
            Behaviour("give", (Condition("far", Linear(5.0, 0.0)),), (Effect("given", 1.0),)),
            Behaviour("other", (Condition("noise", Boolean()),)),
        ],
        [Goal("done", (Condition("given", Boolean()),))],
        NetworkSettings(activation_threshold=0.5, **settings),
    )


class Recorded(Counting):
    def __init__(self, model, answer):
        super().__init__(model)
        self.memory = Forgetful(len(model.goals))
        self.answer = answer

    def plan(self, *_):
        self.calls += 1
        return self.answer


def following(answer=(0, 1), far=5.0, **settings):
    model = errand(**settings)
    network = BehaviourNetwork(model, 1, Recorded(model, None if answer is None else list(answer)))
    step(network, far=far)
    return network


def step(network, **readings):
    """One step; returns how often the planner was asked."""
    calls = network.planner.calls
    network.read(readings)
    network.step()
    return network.planner.calls - calls


def index(network):
    return network.state.plan_marks[0, st.PLAN_INDEX]


def running(network):
    return [b.name for b, on in zip(network.model.behaviours, network.executing[0], strict=True) if on]


COURSES = {
    "a quiet world needs one plan": ({}, [({}, (0, 0))] * 5),
    "without a plan the planner is asked in every step": ({"answer": None}, [({}, (1, 0))] * 3),
    "the expected change passes the step and asks for nothing": ({}, [({}, (0, 0)), ({"far": 4.0}, (0, 1))]),
    "a realised step is passed alone, also before an equal one": (
        {"answer": (0, 0, 1)},
        [({}, (0, 0)), ({"far": 4.0}, (0, 1))],
    ),
    "a change against the effect asks for a plan": ({}, [({"far": 5.5}, (1, 0))]),
    "a change that nothing was expected to bring asks for a plan": ({}, [({"noise": True}, (1, 0))]),
    "a sensor that no condition looks at asks for nothing": ({}, [({"unused": True}, (0, 0))]),
    "M2: a change that six decimals do not show asks for nothing": (
        {"far": 0.25},
        [({"far": 0.25 + 4e-7}, (0, 0)), ({"far": 0.25 + 2e-6}, (1, 0))],
    ),
    "M3: the changes of this step and the one before are held against an effect": (
        {},
        [({"far": 4.5}, (0, 0)), ({"far": 4.0}, (0, 1))],
    ),
    "M3: those of earlier steps are not": (
        {},
        [({"far": 4.5}, (0, 0)), ({}, (0, 0)), ({"far": 4.0}, (0, 0))],
    ),
    "M3: -0.2 and -0.3, added by the machine, make -0.5 or, as here, a little less, below no effect of -0.5": (
        {"far": 0.83, "effect": -0.5},
        [({"far": far}, (0, int(far == 0.13))) for far in (0.83, 0.63, 0.33, 0.13)],
    ),
}
"""How it begins, and what is read in each step: whether a plan is asked for, and which step of it is due."""


@pytest.mark.parametrize("case", COURSES)
def test_a_plan_is_followed(case):
    begin, course = COURSES[case]
    network = following(**begin)
    assert network.planner.calls == 1
    assert [(step(network, **readings), index(network)) for readings, _ in course] == [after for _, after in course]


def test_a_step_that_runs_is_the_first_of_the_plan():
    assert "fetch" in running(following())
    assert (0.63 - 0.83) + (0.33 - 0.63) > -0.5 == (0.33 - 0.63) + (0.13 - 0.33)  # of the last course above


@pytest.mark.parametrize(("strict", "passed"), [(False, 1), (True, 0)])
def test_a_positive_effect_counts_as_realised_at_once_unless_progress_is_strict(strict, passed):
    network = following((1,), far=0.0, strict_progress=strict)
    assert "give" in running(network)
    step(network)
    assert index(network) == passed
    assert step(network, given=True) == 0
    assert index(network) == 1


def test_a_sensor_that_only_optional_conditions_read_asks_for_nothing():
    """M1 of the original."""
    model = errand()
    model = NetworkModel(
        model.sensors,
        [*model.behaviours, Behaviour("look", (Optional(Condition("unused", Boolean())),))],
        model.goals,
        model.settings,
    )
    network = BehaviourNetwork(model, 1, Recorded(model, [0, 1]))
    step(network, far=5.0)
    assert step(network, unused=True) == 0
    assert step(network, noise=True) == 1


def test_a_new_plan_does_not_clear_the_change_of_the_step_before():
    """M3 of the original."""
    network = following()
    network.state.plan_marks[:, st.PLAN_ALARM] = 1
    assert (step(network, far=4.5), index(network)) == (1, 0)
    assert (step(network, far=4.0), index(network)) == (0, 1)


@pytest.mark.parametrize(
    ("plan", "asks", "passed"),
    [
        ((0, 1), 0, 1),
        ((0, 0, 1), 0, 2),  # equal steps that follow one another are passed together
        ((0, 1, 0), 1, 0),  # it is in the plan again later
        ((1,), 1, 0),  # it is not due
    ],
)
def test_a_behaviour_that_ends_itself(plan, asks, passed):
    """M5 of the original."""
    network = following(plan)
    network.finish(ROW, 0)
    assert (step(network), index(network)) == (asks, passed)


def test_behaviours_that_end_in_one_step_pass_theirs_one_after_the_other():
    """M5 of the original."""
    network = following((0, 0, 2, 1))
    network.start_by_hand(ROW, 2, True)
    step(network)
    assert {"fetch", "other"} <= set(running(network))
    for behaviour in (0, 2):
        network.finish(ROW, behaviour)
    assert (step(network), index(network)) == (0, 3)


def test_what_ends_itself_and_was_realised_in_one_step_asks_for_a_plan():
    """M5 of the original."""
    network = following()
    step(network)  # the change of the first step, from 0, no longer counts
    network.finish(ROW, 0)
    assert (step(network, far=4.0), index(network)) == (1, 0)


def test_a_planner_independent_behaviour_that_ends_itself_asks_for_nothing():
    """M5 of the original."""
    model = errand()
    shy = replace(model.behaviours[2], planner_independent=True)
    model = NetworkModel(model.sensors, [*model.behaviours[:2], shy], model.goals, model.settings)
    network = BehaviourNetwork(model, 1, Recorded(model, [0, 1]))
    network.start_by_hand(ROW, 2, True)
    step(network, far=5.0)
    assert "other" in running(network)
    network.finish(ROW, 2)
    assert step(network) == 0


@pytest.mark.parametrize(("held", "asks"), [("", 1), ("not interruptable", 0), ("by hand", 0)])
def test_a_timeout_asks_for_a_plan_only_when_it_stops_the_behaviour(held, asks):
    """M6 of the original."""
    model = errand()
    short = replace(model.behaviours[0], timeout=1, interruptable=held != "not interruptable")
    model = NetworkModel(model.sensors, [short, *model.behaviours[1:]], model.goals, model.settings)
    network = BehaviourNetwork(model, 1, Recorded(model, [0, 1]))
    network.start_by_hand(ROW, 0, held == "by hand")
    step(network, far=5.0)
    assert "fetch" in running(network)
    assert [step(network) for _ in range(3)] == [0, 0, asks]


def test_without_a_goal_the_planner_is_not_asked():
    network = following()
    network.enable_goal(ROW, 0, False)
    network.state.plan_marks[:, st.PLAN_ALARM] = 1
    assert step(network) == 0
    assert network.state.plan_marks[0, st.PLAN_KNOWN] == 0


def test_an_unplanned_behaviour_that_ends_itself_asks_for_a_plan():
    network = following()
    network.start_by_hand(ROW, 2, True)
    assert step(network) == 0
    network.finish(ROW, 2)
    assert step(network) == 1


@pytest.mark.parametrize("event", ["enable", "remove", "disable"])
def test_a_changed_network_asks_for_a_plan(event):
    network = following()
    if event == "remove":
        network.remove(ROW, 2)
    else:
        network.enable(ROW, 2, event == "enable")
    assert step(network) == 1


def test_the_plan_adds_to_the_activation_of_its_behaviours():
    network = following()
    plan = network.state.values[0, st.PLAN]
    np.testing.assert_allclose(plan, [1.0, 0.5, 0.0])


def test_a_plan_longer_than_fits_is_refused():
    network = following()
    with pytest.raises(ValueError, match=f"a plan holds at most {st.MAX_PLAN} steps, got {st.MAX_PLAN + 1}"):
        network.set_plan(0, [0] * (st.MAX_PLAN + 1))
