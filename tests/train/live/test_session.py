"""A session that is changed by hand is recorded, and runs again from its recording with the same bits."""

import json

import pytest

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.recording.reader import RecordedMission
from tests.train.live.sessions import SMALL, play_of
from tests.train.records import checksums
from train.live.chosen import AVOIDING, NEVER, STRATEGY, TRAINED, PlayedMission, again, chosen, usual
from train.live.session import Session

BY_HAND = {
    0: [{"do": "set_loss", "loss": 0.3}],
    7: [
        {"do": "put_robot", "robot": 1, "x": 9.3, "y": 0.7},
        {"do": "hold_option", "option": "RepulsionGradient-view0.5"},
    ],
    15: [{"do": "add_robot", "x": 5.5, "y": 5.5, "heading": 1.0}, {"do": "add_item", "x": 1.0, "y": 2.0}],
    22: [{"do": "put_item", "item": 3, "x": 6.0, "y": 9.0}, {"do": "follow_strategy", "strategy": "fsm:rule"}],
    31: [
        {"do": "hold_option", "robots": [2], "option": "RepulsionFernandez-view2.0"},
        {"do": "fail_robot", "robot": 0},
    ],
    40: [{"do": "remove_robot", "robot": 1}, {"do": "hold_option", "robots": [2]}, {"do": "remove_item", "item": 5}],
}


def played(session: Session, ticks: int = 60, by_hand=BY_HAND) -> bytes:
    """Run a session; return the state at its end."""
    for tick in range(ticks):
        for order in by_hand.get(tick, ()):
            session.do(order)
        session.tick()
    session.close()
    return session.worlds.get_state()


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    path = tmp_path_factory.mktemp("session") / "first.swarm"
    return played(Session(play_of(SMALL), path)), RecordedMission(path)


def test_the_recording_says_what_was_done_by_hand(first):
    done = [(change.tick, change.do) for change in first[1].by_hand]
    assert done == [(tick, order["do"]) for tick, orders in BY_HAND.items() for order in orders]
    assert first[1].by_hand[6].strategy.startswith("fsm:rule sha256:")


def test_it_changed_the_course_from_then_on(first, tmp_path):
    recording = first[1]
    assert [recording[name][7, 1] for name in ("x", "y")] == [9.3, 0.7]
    assert (recording["held/AvoidCollision"][7:20] == 5).all()
    assert recording["held/AvoidCollision"][31:40, 2].tolist() == [3] * 9
    assert recording["present"][15, 6] == 1
    assert recording["working"][[31, 40], [0, 1]].tolist() == [0, 0]
    played(Session(play_of(SMALL), tmp_path / "other.swarm"), by_hand={})
    other = RecordedMission(tmp_path / "other.swarm")
    assert (other["x"][:7] == recording["x"][:7]).all()
    assert (other["x"][8:] != recording["x"][8:]).any(axis=1).all()


def test_it_runs_again_with_the_same_bits(first, tmp_path):
    state, recording = first
    session = Session(again(recording), tmp_path / "second.swarm")
    assert played(session, by_hand={}) == state
    second = RecordedMission(tmp_path / "second.swarm")
    assert checksums(second) == checksums(recording)
    assert second.by_hand == recording.by_hand
    assert second.head == recording.head


def test_a_play_goes_on_by_hand_after_what_was_done_before(first, tmp_path):
    recording = first[1]
    order = {"do": "put_robot", "robot": 3, "x": 2.0, "y": 8.0}
    third, fourth = tmp_path / "third.swarm", tmp_path / "fourth.swarm"
    state = played(Session(again(recording), third), 80, {70: [order]})
    assert RecordedMission(third).by_hand[-1].tick == 70
    assert played(Session(again(RecordedMission(third)), fourth), 80, {}) == state


def test_the_stream_is_the_recording(tmp_path):
    session = Session(play_of(SMALL), tmp_path / "file.swarm")
    (tmp_path / "stream.swarm").write_bytes(
        session.beginning
        + b"".join(session.tick() for _ in range(30) if not session.do({"do": "set_loss", "loss": 0.2}))
    )
    session.close()
    file, stream = (RecordedMission(tmp_path / f"{name}.swarm") for name in ("file", "stream"))
    assert checksums(stream) == checksums(file)
    assert stream.by_hand == file.by_hand
    assert len(stream.by_hand) == 30


def test_a_mission_that_is_over_has_a_result_and_takes_no_changes(tmp_path):
    session = Session(play_of({**SMALL, "time_limit": 2.0}), tmp_path / "over.swarm")
    while session.result is None:
        last = session.tick()
    assert b"DONE" in last
    assert session.tick() == b""
    with pytest.raises(ValueError, match="the mission is over"):
        session.do({"do": "set_loss", "loss": 0.2})
    session.close()
    assert RecordedMission(tmp_path / "over.swarm").result["ticks"] == 10


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A session that refuses what it is told."""
    session = Session(play_of(SMALL), tmp_path_factory.mktemp("small") / "small.swarm")
    yield session
    session.close()


@pytest.mark.parametrize(
    ("order", "expected"),
    [
        ({"do": "dance"}, "unknown change by hand 'dance' .*put_robot"),
        ({}, "unknown change by hand ''"),
        ({"do": "put_robot", "robot": 1, "x": float("nan"), "y": 0.0}, "by hand: .*x"),
        ({"do": "put_robot", "robot": 1, "x": 1.0}, "by hand: .*y"),
        ({"do": "hold_option", "option": "Repulsion"}, "unknown option 'Repulsion' \\(known: "),
        (
            {"do": "hold_option", "option": "RepulsionGradient-view0.5", "robots": [99]},
            "robot 99: expected a number below",
        ),
        ({"do": "follow_strategy", "strategy": "policy:none"}, "none"),
        ({"do": "set_loss", "loss": 2}, "by hand: .*loss"),
    ],
)
def test_an_odd_order_is_one_line(small, order, expected):
    before = small.worlds.get_state()
    with pytest.raises(ValueError, match=expected) as error:
        small.do(order)
    assert len(str(error.value).splitlines()) == 1
    assert small.worlds.get_state() == before


def test_a_policy_plays_for_the_goal_that_it_was_trained_for(tmp_path):
    changes = {**SMALL, "knowledge": "exploring", "network": {"robot": "cleaning-patrol"}, "terms": ["finds"]}
    session = Session(play_of(changes, "policy:exploring-ppo"), tmp_path / "policy.swarm")
    assert session.goal == "ExplorationPatrol"
    session.tick()
    session.close()


def test_strategies_are_those_that_fit(small, tmp_path):
    assert {"MaxScore", "Random", "fixed:Off", "fsm:rule"} <= set(small.offered()["strategies"])
    session = Session(play_of({**SMALL, "knowledge": "cleaning"}), tmp_path / "two.swarm")
    fixed = [f"fixed:{option}" for option in session.options]
    assert session.offered()["strategies"] == ["MaxScore", "policy:one", *fixed, "Random"]
    session.close()


def test_a_play_whose_files_have_changed_is_refused(first, tmp_path):
    recording = first[1]
    described = json.loads(json.dumps(recording.head))
    recording.head["about"]["play"]["files"]["knowledge/avoidance.yaml"] = "0"
    with pytest.raises(ConfigurationError, match="have changed since it was played"):
        again(recording)
    del recording.head["about"]["play"]
    with pytest.raises(ConfigurationError, match="expected a recording of `clean-swarm play`"):
        again(recording)
    recording.head.update(described)
    changed = PlayedMission(**{**vars(again(recording)), "strategy": "fsm:rule sha256:0"})
    with pytest.raises(ConfigurationError, match="fsm:rule has changed since"):
        Session(changed, tmp_path / "changed.swarm")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("crowded", (AVOIDING, STRATEGY)),
        ("crowded-exploring", (TRAINED, NEVER)),
        ("table1", (STRATEGY, "")),
        ("bumpers", (AVOIDING, "")),
        ("ReachGoal", (STRATEGY, "")),
    ],
)
def test_a_mission_opens_with_the_strategy_that_is_best_there(name, expected):
    play = chosen(name, 1, 0, None, ())
    assert (play.strategy, *usual(play.scenario.mission, ())) == (expected[0], *expected)
    assert chosen(name, 1, 0, "Random", ()).strategy == "Random"


def test_other_knowledge_brings_its_options_and_the_recording_has_them(tmp_path):
    paths = [tmp_path / name for name in ("once.swarm", "twice.swarm")]
    played(Session(chosen("table1", 1, 0, "fixed:ORCA", (), "avoidance"), paths[0]), ticks=9, by_hand={})
    played(Session(chosen(str(paths[0]), 1, 0, None, ()), paths[1]), ticks=9, by_hand={})
    once, twice = (RecordedMission(path) for path in paths)
    assert "ORCA" in once.head["options"]["AvoidCollision"]
    assert checksums(once) == checksums(twice)
