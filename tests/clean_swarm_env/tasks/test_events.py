"""Robots of any task that says so come and go during a mission; the others refuse, and name the event."""

import numpy as np
import pytest

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.batch import Batch
from tests.clean_swarm_env.courses import begun

EVENTS = [
    {"at": 2.0, "do": "fail", "robots": [0, 1]},
    {"at": 4.0, "do": "remove", "robots": [2]},
    {"at": 5.0, "do": "join", "robots": 2},
    {"at": 6.0, "do": "deliver", "loss": 0.5},
]


def foraging(events, **changes):
    mission = {"task": "Foraging", "robots": {"count": 6}, "time_limit": 10.0, "events": events}
    return begun(Batch({**mission, **changes}, 2, begin_anew=False), [3, 4])


def test_robots_fail_leave_and_join_while_they_forage():
    batch = foraging(EVENTS)
    worlds, default = batch.worlds, np.full(batch.rows, batch.choices.default[0])
    at_work = []
    for _ in range(10):
        batch.step(default)
        at_work.append(worlds.team.working.reshape(2, -1).sum(axis=1).tolist())
    assert at_work[0] == [6, 6]
    assert at_work[2] == [4, 4]
    assert at_work[-1] == [5, 5]
    assert worlds.minds.reception.losses.tolist() == [0.5, 0.5]
    assert worlds.team.joined.tolist() == [8, 8]


def test_what_a_lost_robot_carried_is_not_brought():
    batch = foraging([])
    worlds = batch.worlds
    worlds.minds.memory["carrying"].values[:] = 1.0
    worlds.physics.positions[:] = worlds.world.ground.centre
    worlds.task.state.carried[:] = True
    worlds.team.fail(np.array([0]))
    worlds.task.after_moving()
    assert worlds.task.state.brought.tolist() == [0, 0]
    assert worlds.task.state.carried.tolist() == [False] + [True] * 11


@pytest.mark.parametrize(
    ("task", "event", "expected"),
    [
        ("Foraging", {"at": 1.0, "do": "land", "items": 2}, "join, remove, fail or deliver"),
        ("MaxValue", EVENTS[0], "none"),
    ],
)
def test_an_event_that_a_task_does_not_know_is_refused_by_its_number(task, event, expected):
    line = rf"events\.0: expected {expected} with the task {task}, got {event['do']}"
    with pytest.raises(ConfigurationError, match=line):
        Batch({"task": task, "robots": {"count": 6}, "events": [event]}, 1)
