"""Explanations as data are those of the arrays, and what cannot be explained is one line."""

import numpy as np
import pytest

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.explaining import explain_robot
from tests.clean_swarm_env.courses import begun, course_of, mission, ticked

SHORT = mission(time_limit=12.0)


def explained(config=SHORT):
    return course_of(config, 3, 17, explained=True)


def test_a_robot_that_joins_is_told_of_from_then_on():
    batch = ticked(explained(mission(time_limit=4.0, events=({"at": 2.0, "do": "join"},))), 10)
    with pytest.raises(ValueError, match=r"robot 5: expected a robot that is in the team at 1.8 s; it joins at 2 s"):
        explain_robot(batch.worlds, 5)
    steps = []
    while not batch.over[0]:
        steps.append(explain_robot(ticked(batch).worlds, 5))
    assert [step.time_s for step in steps] == pytest.approx(np.arange(10, 20) * 0.2)
    assert {step.robot for step in steps} == {5}
    spare = mission(time_limit=4.0, robots={"count": 5, "capacity": 6})
    with pytest.raises(ValueError, match=r"robot 5: .* it never joins"):
        explain_robot(ticked(explained(spare)).worlds, 5)


def test_accounts_and_arrays_agree_in_every_robot():
    course = ticked(explained(), 30)
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


@pytest.mark.parametrize(
    ("worlds", "row", "message"),
    [
        (lambda: ticked(explained()).worlds, 5, "robot: expected a row from 0 to 4, got 5"),
        (lambda: ticked(course_of(SHORT, 3, 17)).worlds, 0, "expected worlds with explained=True"),
        (lambda: explained().worlds, 0, "expected a world that has run a control period"),
    ],
)
def test_other_robots_and_worlds_without_reasons_are_named(worlds, row, message):
    with pytest.raises(ValueError, match=message):
        explain_robot(worlds(), row)
