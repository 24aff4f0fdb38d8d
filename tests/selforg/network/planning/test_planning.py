"""From the model to plans, and the memory of plans."""

import numpy as np
import pytest

from selforg.network import state as st
from selforg.network.model.activators import Boolean
from selforg.network.model.behaviours import Behaviour, Effect, Goal, Sensor
from selforg.network.model.conditions import Condition
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from tests.selforg.network.cleaning import SENSORS, cleaning_model, wandering

CHAIN = ["MoveToGarbage", "PickGarbage", "MoveToRecycling", "Recycle", "MoveToDump", "Dump"]


class Counting(Planner):
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
        state = network.state
        told.append((state.marks.copy(), state.values.copy(), state.plan_marks[:, : st.PLAN_ALARM].copy()))
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
    found = Planner(model).plan(readings_of(*facts), np.zeros(8, np.int64), np.ones(3, np.int64))
    assert [model.behaviours[b].name for b in found] == plan


def test_goals_that_are_off_take_no_part():
    model = cleaning_model()
    goals = np.array([0, 1, 0])  # GarbageCleaned alone
    seen = readings_of("garbage_seen", "garbage_found", "rep_bool")
    found = Planner(model).plan(seen, np.zeros(8, np.int64), goals)
    assert [model.behaviours[b].name for b in found] == CHAIN


def test_a_planner_independent_behaviour_is_in_no_plan():
    wanted = Goal("warm", (Condition("warm", Boolean()),))
    heat = {"preconditions": (), "effects": (Effect("warm", 1.0),)}
    sensors = [Sensor("warm", "fact")]
    own = NetworkModel(sensors, [Behaviour("heat", **heat)], [wanted])
    shy = NetworkModel(sensors, [Behaviour("heat", planner_independent=True, **heat)], [wanted])
    question = np.zeros(1), np.zeros(1, np.int64), np.ones(1, np.int64)
    assert Planner(own).plan(*question) == [0]
    assert Planner(shy).plan(*question) is None
