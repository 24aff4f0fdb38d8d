"""Goals are played in their scenes, changed by hand, and run again with the same bits."""

import numpy as np
import pytest

from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.scenes import find, goals
from clean_swarm_env.scenes.served import ServedTeam, expertise
from train.live.chosen import again, chosen

BY_HAND = {
    3: {"do": "put_robot", "robot": 2, "x": 1.0, "y": 1.5},
    20: {"do": "hold_option", "robots": [1], "option": "ChemotaxisGe"},
    40: {"do": "put_robot", "robot": 0, "x": 17.0, "y": 3.0},
}


def played(session, ticks=60, by_hand=BY_HAND):
    for tick in range(ticks):
        if tick in by_hand:
            session.do(by_hand[tick])
        session.tick()
    session.close()
    return session


def test_a_goal_takes_the_course_that_it_has_in_its_scene(tmp_path):
    session = chosen("ReachGoal", 1, 4, None, ()).open(tmp_path / "a.swarm", minds=False)
    while session.result is None:
        session.tick()
    session.close()
    expert = expertise("ReachGoal")
    run = find("ReachGoal")(find("ReachGoal").setting, (4,)).run(lambda scene: ServedTeam(scene, expert))
    recording = RecordedMission(tmp_path / "a.swarm")
    np.testing.assert_allclose(recording["x"], run.tracks[:-1, :, 0], atol=0.0005001)
    assert recording.result["measures"] == {name: float(values[0]) for name, values in run.values.items()}


def test_a_goal_that_was_changed_by_hand_runs_again_with_the_same_bits(tmp_path):
    first = played(chosen("ReachGoal", 1, 4, None, ()).open(tmp_path / "a.swarm", minds=False))
    recording = RecordedMission(tmp_path / "a.swarm")
    assert [recording[name][3, 2] for name in "xy"] == [1.0, 1.5]
    assert [change.tick for change in recording.by_hand] == list(BY_HAND)
    second = played(again(recording).open(tmp_path / "b.swarm", minds=False), by_hand={})
    np.testing.assert_array_equal(first.scene.arena.positions, second.scene.arena.positions)
    assert RecordedMission(tmp_path / "b.swarm").checksums() == recording.checksums()


def test_what_scenes_do_not_have_is_one_line(tmp_path):
    session = chosen("ReachGoal", 1, 4, None, ()).open(tmp_path / "a.swarm", minds=False)
    x, y = session.scene.arena.positions[1].tolist()
    for order, expected in (
        ({"do": "add_item", "x": 1.0, "y": 1.0}, "expected put_robot, hold_option or follow_strategy"),
        ({"do": "put_robot", "robot": 99, "x": 1.0, "y": 1.0}, "robot 99: expected a robot that is there"),
        ({"do": "put_robot", "robot": 0, "x": x, "y": y}, "robot 0: another robot is at the place"),
        ({"do": "hold_option", "option": "x"}, "unknown option 'x'"),
        ({"do": "hold_option", "robots": [77], "option": session.strategies()[0][6:]}, "robot 77: expected a number"),
    ):
        with pytest.raises(ValueError, match=expected):
            session.do(order)
    session.close()


@pytest.mark.parametrize("goal", goals())
def test_every_goal_can_be_played(tmp_path, goal):
    session = chosen(goal, 1, 0, None, ()).open(tmp_path / "a.swarm", minds=False)
    for _ in range(3):
        session.tick()
    assert session.facts()["strategy"] in session.strategies()
    session.close()
    recording = RecordedMission(tmp_path / "a.swarm")
    assert recording.frames == 3
    assert set(np.unique(recording[f"held/{goal}"])) <= set(range(len(recording.head["options"][goal])))
