"""From the model to plans, the memory of plans, and how a plan is followed."""

from dataclasses import replace

import numpy as np
import pytest

from selforg.network.model.activators import Boolean, Linear
from selforg.network.model.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor
from selforg.network.model.conditions import Condition, Optional
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import BuiltInPlanner
from selforg.network.state import plan_state as ps
from selforg.network.state import state as st
from tests.golden.network.traces import Forgetful
from tests.selforg.network.cleaning import FACTS, SENSORS, cleaning_model, wandering

CHAIN = ["MoveToGarbage", "PickGarbage", "MoveToRecycling", "Recycle", "MoveToDump", "Dump"]
ROW = np.array([0])


class Counting(BuiltInPlanner):
    def __init__(self, model):
        super().__init__(model)
        self.calls = 0

    def plan(self, *question):
        self.calls += 1
        return super().plan(*question)


class Memoryless(Counting):
    """Its keys are as long as they were, but nothing is kept."""

    def __init__(self, model):
        super().__init__(model)
        self.memory.insert = lambda key, steps: None


def decisions(planner, readings):
    network = BehaviourNetwork(planner.model, readings.shape[1], planner)
    told = []
    for now in readings:
        network.readings[:] = now
        network.step()
        told.append((network.state.marks.copy(), network.state.values.copy(), network.plans.marks[: ps.ALARM].copy()))
    return told


@pytest.mark.parametrize("seed", range(3))
def test_remembering_plans_changes_no_decision(seed):
    readings, model = wandering(np.random.default_rng(seed), 60, 8), cleaning_model()
    remembering, forgetting = Counting(model), Memoryless(model)
    for one, other in zip(decisions(remembering, readings), decisions(forgetting, readings), strict=True):
        for ours, theirs in zip(one, other, strict=True):
            np.testing.assert_array_equal(ours, theirs)
    assert 0 < remembering.calls < forgetting.calls


def test_the_memory_grows_and_still_finds_everything():
    model = cleaning_model()
    planner = Counting(model)
    readings = wandering(np.random.default_rng(5), 1, 400)
    decisions(planner, readings)
    calls = planner.calls
    assert planner.memory.count > 128  # more than half of the first table
    decisions(planner, readings)
    assert planner.calls == calls


def readings_of(*facts, far=5.0):
    return np.array([float(s.name in facts) if s.kind == "fact" else far for s in SENSORS])


@pytest.mark.parametrize(
    ("facts", "plan"),
    [
        ((), ["Patrol"]),
        (("garbage_seen", "garbage_found"), [*CHAIN, "Patrol"]),
        (("carrying", "garbage_found"), [*CHAIN[2:], "Patrol"]),
        (("carrying", "garbage_found", "at_recycling"), [*CHAIN[3:], "Patrol"]),
        (("carrying", "garbage_found", "recycled", "at_dump"), ["Dump", "Patrol"]),
    ],
)
def test_the_robot_plans_its_tasks_from_where_it_stands(facts, plan):
    model = cleaning_model()
    found = BuiltInPlanner(model).plan(readings_of(*facts), np.zeros(8, np.int64), np.ones(3, np.int64))
    assert [model.behaviours[b].name for b in found] == plan


def test_goals_that_are_off_take_no_part():
    model = cleaning_model()
    goals = np.array([0, 1, 0])  # GarbageCleaned alone
    seen = readings_of("garbage_seen", "garbage_found", "rep_bool")
    found = BuiltInPlanner(model).plan(seen, np.zeros(8, np.int64), goals)
    assert [model.behaviours[b].name for b in found] == CHAIN


def test_a_planner_independent_behaviour_is_in_no_plan():
    wanted = Goal("warm", (Condition("warm", Boolean()),))
    heat = {"preconditions": (), "effects": (Effect("warm", 1.0),)}
    sensors = [Sensor("warm", "fact")]
    own = NetworkModel(sensors, [Behaviour("heat", **heat)], [wanted])
    shy = NetworkModel(sensors, [Behaviour("heat", planner_independent=True, **heat)], [wanted])
    question = np.zeros(1), np.zeros(1, np.int64), np.ones(1, np.int64)
    assert BuiltInPlanner(own).plan(*question) == [0]
    assert BuiltInPlanner(shy).plan(*question) is None


# following a plan


def errand(**settings):
    """First fetch (far comes down), then give; something else may happen to `noise`."""
    return NetworkModel(
        [Sensor("far"), Sensor("given", "fact"), Sensor("noise", "fact"), Sensor("unused", "fact")],
        [
            Behaviour("fetch", effects=(Effect("far", -1.0),)),
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
    return network.plans.marks[ps.INDEX, 0]


def running(network):
    return [b.name for b, on in zip(network.model.behaviours, network.executing[0], strict=True) if on]


def test_a_quiet_world_needs_one_plan():
    network = following()
    assert network.planner.calls == 1
    assert [step(network) for _ in range(5)] == [0] * 5


def test_without_a_plan_the_planner_is_asked_every_step():
    network = following(None)
    assert [step(network) for _ in range(3)] == [1, 1, 1]


def test_the_expected_change_passes_the_step_and_asks_for_nothing():
    network = following()
    assert "fetch" in running(network)
    assert (step(network), index(network)) == (0, 0)
    assert (step(network, far=4.0), index(network)) == (0, 1)


def test_a_change_against_the_effect_asks_for_a_plan():
    network = following()
    assert step(network, far=5.5) == 1


def test_a_change_that_nothing_was_expected_to_bring_asks_for_a_plan():
    network = following()
    assert step(network, noise=True) == 1


def test_a_sensor_that_no_condition_looks_at_asks_for_nothing():
    network = following()
    assert step(network, unused=True) == 0


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


def test_a_change_that_six_decimals_do_not_show_asks_for_nothing():
    """M2 of the original."""
    network = following(far=0.25)
    assert step(network, far=0.25 + 4e-7) == 0
    assert step(network, far=0.25 + 2e-6) == 1


def test_only_the_change_of_this_step_and_the_one_before_is_held_against_an_effect():
    """M3 of the original."""
    network = following()
    for far in (4.5, 4.0):
        assert (step(network, far=far), index(network)) == (0, int(far < 4.5))
    network = following()
    step(network, far=4.5)
    step(network)
    assert (step(network, far=4.0), index(network)) == (0, 0)  # half of the effect, and nothing the step before


def test_a_new_plan_does_not_clear_the_change_of_the_step_before():
    """M3 of the original."""
    network = following()
    network.plans.marks[ps.ALARM] = 1
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
    network.plans.marks[ps.ALARM] = 1
    assert step(network) == 0
    assert network.plans.marks[ps.KNOWN, 0] == 0


def test_an_unplanned_behaviour_that_ends_itself_asks_for_a_plan():
    network = following()
    network.start_by_hand(ROW, 2, True)
    assert step(network) == 0
    network.finish(ROW, 2)
    assert step(network) == 1


def test_the_due_behaviour_that_ends_itself_passes_its_step():
    network = following()
    network.finish(ROW, 0)
    assert (step(network), index(network)) == (0, 1)


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
    plan = network.state.values[st.PLAN, 0]
    np.testing.assert_allclose(plan, [1.0, 0.5, 0.0])


def test_a_plan_longer_than_fits_is_refused():
    network = following()
    with pytest.raises(ValueError, match=f"a plan holds at most {ps.MAX_PLAN} steps, got {ps.MAX_PLAN + 1}"):
        network.set_plan(0, [0] * (ps.MAX_PLAN + 1))


def test_facts_lists_all_booleans():
    assert [s.name for s in SENSORS if s.kind == "fact"] == list(FACTS)
