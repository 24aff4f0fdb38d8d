"""Missions of every task are played, changed by hand, and run again with the same bits."""

import numpy as np
import pytest

from clean_swarm_env.config.task_names import task_names
from clean_swarm_env.recording.reader import RecordedMission
from tests.clean_swarm_env.recording.shepherding import with_shepherding
from train.live.chosen import chosen
from train.live.session import Session


@pytest.mark.parametrize("task", [*task_names(), "Shepherding"])
def test_every_task_can_be_played(tmp_path, task, monkeypatch):
    with_shepherding(monkeypatch)
    session = Session(chosen(task, 1, 0, None, ()), tmp_path / "a.swarm", minds=False)
    for _ in range(3):
        session.tick()
    assert session.strategy == "MaxScore"
    assert {"MaxScore", "Random"} <= set(session.offered()["strategies"])
    session.close()
    recording = RecordedMission(tmp_path / "a.swarm")
    assert recording.frames == 3
    assert recording.head["about"]["experiment"] == task


def test_food_is_put_elsewhere_by_hand_and_is_recorded_seen_and_put_there_again(tmp_path):
    session = Session(chosen("Foraging", 1, 0, None, ()), tmp_path / "a.swarm", minds=False)
    session.tick()
    robot, food = session.worlds.physics.positions[0].tolist(), session.worlds.task.state.patches[0]
    stayed = food[0].tolist()
    assert not session.worlds.world.carrying.any()
    for order, expected in (
        ({"do": "put_food", "patch": 2, "x": 1.0, "y": 1.0}, "patch 2: expected a number below 2"),
        ({"do": "put_food", "patch": 1, "x": 1.0}, "by hand: y: missing key"),
        ({"do": "put_item", "item": 1, "x": 1.0, "y": 1.0}, "put_item: expected the task Cleaning, got Foraging"),
    ):
        with pytest.raises(ValueError, match=expected):
            session.do(order)
    session.do({"do": "put_food", "patch": 1, "x": robot[0] + 30.0, "y": robot[1]})
    for _ in range(3):
        session.tick()
    assert session.worlds.world.carrying[0]  # it has taken of the food that came to it
    session.close()
    recording = RecordedMission(tmp_path / "a.swarm")
    assert [thing["moves"] for thing in recording.head["things"]] == [0, 1, 2]
    places = np.stack([recording["thing_x"], recording["thing_y"]], axis=2)
    np.testing.assert_allclose(places[3, :2], [stayed, robot], atol=1e-3)
    assert np.hypot(*(places[0, 1] - robot)) > 3.0
    again = Session(chosen(str(tmp_path / "a.swarm"), 1, 0, None, ()), tmp_path / "b.swarm", minds=False)
    while again.ticks < 4:
        again.tick()
    again.close()
    repeated = RecordedMission(tmp_path / "b.swarm")
    assert repeated.by_hand == recording.by_hand
    assert all((repeated.whole(name) == recording.whole(name)).all() for name in recording)


def test_what_other_tasks_do_not_have_is_one_line(tmp_path):
    session = Session(chosen("ReachGoal", 1, 4, None, ()), tmp_path / "a.swarm", minds=False)
    x, y = session.worlds.physics.positions[1].tolist()
    before = session.worlds.get_state()
    for order, expected in (
        ({"do": "add_item", "x": 1.0, "y": 1.0}, "expected the task Cleaning, got ReachGoal"),
        ({"do": "put_item", "item": 0, "x": 1.0, "y": 1.0}, "expected the task Cleaning, got ReachGoal"),
        ({"do": "remove_item", "item": 0}, "expected the task Cleaning, got ReachGoal"),
        ({"do": "add_robot", "x": 1.0, "y": 1.0}, "expected at most 6 robots over the mission"),
        ({"do": "put_robot", "robot": 99, "x": 1.0, "y": 1.0}, "robot 99: expected a robot that is there"),
        ({"do": "put_robot", "robot": 0, "x": x, "y": y}, "robot 0: another robot is at the place"),
        ({"do": "hold_option", "option": "x"}, "unknown option 'x'"),
        ({"do": "hold_option", "robots": [77], "option": session.options[0]}, "robot 77: expected a number"),
    ):
        with pytest.raises(ValueError, match=expected) as error:
            session.do(order)
        assert len(str(error.value).splitlines()) == 1
    assert session.worlds.get_state() == before
    session.close()
