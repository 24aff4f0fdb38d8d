"""Explanations as data are those of the arrays, and what cannot be explained is one line."""

import math

import numpy as np
import pytest

from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.explaining import explain_robot
from clean_swarm_env.world.mission import Course, MissionRun
from tests.clean_swarm_env.courses import begun, mission, ticked

SHORT = mission(time_limit=12.0)


def mission_run():
    return MissionRun(SHORT, random_start(SHORT, 3, 0), 17, {})


def test_the_stream_tells_of_every_period_what_is_told_of_one():
    steps = list(mission_run().explanations(3))
    assert [step.step for step in steps] == list(range(60))
    assert steps[31] == mission_run().explain(3, 6.2)


def test_a_robot_that_joins_is_told_of_from_then_on():
    joining = mission(time_limit=4.0, events=({"at": 2.0, "do": "join"},))
    joined = MissionRun(joining, random_start(joining, 3, 0), 17, {})
    assert [step.time_s for step in joined.explanations(5)] == pytest.approx(np.arange(10, 20) * 0.2)
    assert joined.explain(5, 2.0).robot == 5
    with pytest.raises(ValueError, match=r"robot 5: expected a robot that is in the team at 1.8 s; it joins at 2 s"):
        joined.explain(5, 1.8)
    spare = mission(time_limit=4.0, robots={"count": 5, "capacity": 6})
    with pytest.raises(ValueError, match=r"robot 5: .* it never joins"):
        MissionRun(spare, random_start(spare, 3, 0), 17, {}).explain(5, 1.0)


def test_accounts_and_arrays_agree_in_every_robot():
    course = ticked(Course(mission_run(), explained=True), 30)
    network = course.worlds.network
    names = [behaviour.name for behaviour in network.model.behaviours]
    for row in range(course.worlds.rows):
        step = explain_robot(course.worlds, row)
        assert (step.robot, step.step, step.time_s) == (row, 29, 5.8)
        for account in step.network.behaviours:
            b = names.index(account.name)
            assert account.activation == network.activation[row, b]
            assert account.components == {name: values[row, b] for name, values in network.components.items()}
            assert account.running == bool(network.executing[row, b])
    assert np.abs(network.activation).max() > 0.0


def test_every_world_of_a_batch_can_be_explained():
    batch = begun(Batch(SHORT, worlds=2, explained=True), [1, 2])
    for worlds in batch.ticks(np.zeros(batch.rows, dtype=np.int64)):
        steps = [explain_robot(worlds, row) for row in (0, batch.robots)]
        assert [step.robot for step in steps] == [0, 0]
        assert steps[0].network != steps[1].network


@pytest.mark.parametrize("time", [-1.0, math.nan, math.inf, 12.0, 1e12])
def test_a_time_out_of_the_mission_is_named(time):
    with pytest.raises(ValueError, match="time: expected seconds from 0 to the end of the mission at"):
        mission_run().explain(0, time)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mission_run().explain(5, 1.0), "robot: expected a number from 0 to 4, got 5"),
        (lambda: next(mission_run().explanations(5)), "robot: expected a number from 0 to 4, got 5"),
        (lambda: explain_robot(Course(mission_run()).worlds, 0), "expected worlds with explained=True"),
        (
            lambda: explain_robot(Course(mission_run(), explained=True).worlds, 0),
            "expected a world that has run a control period",
        ),
    ],
)
def test_other_robots_and_worlds_without_reasons_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
