"""Missions of every task are played, changed by hand, and run again with the same bits."""

import pytest

from clean_swarm_env.config.task_names import task_names
from clean_swarm_env.recording.reader import RecordedMission
from tests.clean_swarm_env.recording.shepherding import with_shepherding
from tests.train.live.test_session import played
from train.live.chosen import again, chosen
from train.live.session import Session

BY_HAND = {
    3: [{"do": "put_robot", "robot": 2, "x": 1.0, "y": 1.5}],
    12: [{"do": "set_loss", "loss": 0.5}, {"do": "fail_robot", "robot": 0}],
    20: [{"do": "hold_option", "robots": [1], "option": "ChemotaxisGe"}],
    31: [{"do": "remove_robot", "robot": 3}, {"do": "follow_strategy", "strategy": "Random"}],
    40: [{"do": "put_robot", "robot": 0, "x": 17.0, "y": 3.0}],
}


@pytest.mark.parametrize("task", [*task_names(), "Shepherding"])
def test_every_task_can_be_played(tmp_path, task, monkeypatch):
    with_shepherding(monkeypatch)
    session = Session(chosen(task, 1, 0, None, ()), tmp_path / "a.swarm", minds=False)
    for _ in range(3):
        session.tick()
    assert session.facts() == {"strategy": "MaxScore", "loss": 0.0}
    assert {"MaxScore", "Random"} <= set(session.strategies())
    session.close()
    recording = RecordedMission(tmp_path / "a.swarm")
    assert recording.frames == 3
    assert recording.head["about"]["experiment"] == task


def test_a_task_that_was_changed_by_hand_runs_again_with_the_same_bits(tmp_path):
    first = Session(chosen("ReachGoal", 1, 4, None, ()), tmp_path / "a.swarm", minds=False)
    played(first, by_hand=BY_HAND)
    recording = RecordedMission(tmp_path / "a.swarm")
    assert [recording[name][3, 2] for name in "xy"] == [1.0, 1.5]
    assert [change.tick for change in recording.by_hand] == [tick for tick, orders in BY_HAND.items() for _ in orders]
    second = Session(again(recording), tmp_path / "b.swarm", minds=False)
    played(second, by_hand={})
    assert first.worlds.physics.bodies.tobytes() == second.worlds.physics.bodies.tobytes()
    assert RecordedMission(tmp_path / "b.swarm").checksums() == recording.checksums()


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
