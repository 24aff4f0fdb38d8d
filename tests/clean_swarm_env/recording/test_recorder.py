"""A recorded mission takes its own course, and its recording holds it, with traces, losses and changes of the team."""

from dataclasses import replace

import numpy as np
import pytest

from clean_swarm_env.borders.gymnasium_vector import TeamVectorEnv
from clean_swarm_env.clean_swarm_v0 import parallel_env
from clean_swarm_env.learning.batch import run_out
from clean_swarm_env.recording import taking
from clean_swarm_env.recording.fields import traces_at
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import MissionRecorder, RecordSettings
from selforg.gradients.store import columns as c
from selforg.network import state as st
from tests.clean_swarm_env.courses import begun, course_of, mission, recorded, run_recorded

EVENTS = (
    {"at": 4.0, "do": "join", "robots": 1},
    {"at": 7.0, "do": "fail", "robots": [1]},
    {"at": 9.0, "do": "remove", "robots": [2]},
    {"at": 10.0, "do": "land", "items": 2},
)
MISSION = mission(robots={"count": 6}, events=EVENTS, time_limit=40.0, delivery={"loss": 0.3}, knowledge="avoidance")
HALF_STEP = 0.5001 / 1000


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """Recording of a mission, and what was read off the worlds tick by tick."""
    course = course_of(MISSION, 3, 17, explained=True)
    worlds, net = course.worlds, course.worlds.network

    def frame():
        own = worlds.minds.poses.own[:, 0]
        parts = {
            "x": own[:, c.X],
            "y": own[:, c.Y],
            "working": worlds.team.working,
            "cargo": worlds.task.garbage.cargo,
            "item_stage": worlds.task.garbage.stage[0],
            "contact": worlds.collisions.entered_in_tick,
            "robot/values": net.state.values,
            "robot/running": net.executing,
            "robot/reason": net.state.marks[:, st.REASON],
            "robot/readings": net.readings,
            "robot/goals": net.state.goal_satisfaction,
            "inner": worlds.coordinators[0].contents[0].network.state.values,
        }
        return {name: part.copy() for name, part in parts.items()} | {"traces": set(stored(worlds))}

    folder = tmp_path_factory.mktemp("recordings")
    recording, frames = recorded(course, folder, frame, room=64, minds=True, thinking=True)  # several parts
    return recording, frames[1:], course


def stored(worlds) -> list[tuple[int, float, float]]:
    """Who left each pheromone that any robot has stored, and where [m]."""
    table = worlds.minds.buffers["pheromones"].table.record
    used = np.flatnonzero(table.links[: table.counters[c.COUNTER_HIGH], c.LINK_LAYER] >= 0)
    return list(
        zip(table.marks[used, c.MARK_SOURCE].tolist(), *table.near[used, c.X : c.X + 2].T.tolist(), strict=True)
    )


def test_recording_changes_no_mission(tmp_path):
    plain = run_out(course_of(MISSION, 3, 17))
    for minds in (False, True):
        record = RecordSettings(tmp_path / str(minds), minds)
        assert run_out(course_of(MISSION, 3, 17, record=record)) == plain


def test_without_addresses_the_same_bytes_are_recorded(tmp_path, monkeypatch):
    short = MISSION.model_copy(update={"time_limit": 12.0})
    written = []
    for by_address in (True, False):
        monkeypatch.setattr(taking, "BY_ADDRESS", by_address)
        written.append(run_recorded(short, 3, 17, tmp_path, str(by_address), minds=True).path.read_bytes())
    assert written[0] == written[1]


def test_a_frame_holds_where_robots_are_and_what_they_then_decide(seen):
    recording, frames, course = seen
    assert recording.frames == len(frames) == course.worlds.ticks[0]
    assert recording.result["ticks"] == recording.frames
    for name in ("working", "cargo", "item_stage", "contact", "robot/running", "robot/reason"):
        np.testing.assert_array_equal(recording[name], np.array([frame[name] for frame in frames]), name)
    for name in ("robot/values", "robot/readings", "robot/goals"):
        assert np.abs(recording[name] - np.array([frame[name] for frame in frames])).max() <= HALF_STEP, name
    there = recording["working"] == 1
    for name in ("x", "y"):
        assert np.abs(recording[name] - np.array([frame[name] for frame in frames]))[there].max() <= HALF_STEP
    option = recording.head["options"]["AvoidCollision"][0]
    held = (recording["held/AvoidCollision"] == 0).any(axis=1)
    inner = np.abs(recording[f"AvoidCollision/{option}/values"] - np.array([frame["inner"] for frame in frames]))
    assert held.all()
    assert inner.max() <= HALF_STEP


def test_who_joins_fails_and_goes_is_seen(seen):
    recording = seen[0]
    present, working = recording["present"] == 1, recording["working"] == 1
    assert np.flatnonzero(present[:, 6])[0] * recording.period == pytest.approx(4.0)
    assert present[-1].tolist() == [True, True, False, True, True, True, True]
    assert working[-1].tolist() == [True, False, False, True, True, True, True]
    assert (recording["item_stage"][-1] != 3).sum() == 12


def test_messages_are_missed_as_often_as_they_get_lost(seen):
    recording = seen[0]
    before = slice(0, round(4.0 / recording.period))
    missed = recording["missed"][before, :6].mean() / 5
    assert missed == pytest.approx(0.3, abs=0.06)


def test_traces_are_rebuilt_where_robots_stored_them(seen):
    recording, frames, _ = seen
    for frame in (30, 120, len(frames) - 1):
        rebuilt = traces_at(recording, frame + 1)  # the buffer was read after the deposits of the tick
        kept = frames[frame]["traces"]
        assert len(kept) > 10
        for source, x, y in kept:
            off = np.abs(rebuilt.positions[rebuilt.robot == source] - (x, y)).max(axis=1)
            assert off.min() <= HALF_STEP, (frame, source, x, y)
    assert recording.notes["deposits"][0]["channel"] == "pheromone"


def test_what_the_strategy_thinks_is_kept(seen, tmp_path):
    recording, _, course = seen
    scores = course.worlds.coordinators[0].model.scores
    assert np.abs(recording["opinion/AvoidCollision"] - scores).max() <= HALF_STEP


def test_every_border_records(tmp_path):
    short = MISSION.model_copy(update={"time_limit": 4.0})
    env = begun(parallel_env(short, record=RecordSettings(tmp_path / "one", minds=True)), seed=1)
    while env.agents:
        env.step(dict.fromkeys(env.agents, 3))
    (path,) = (tmp_path / "one").iterdir()
    assert RecordedMission(path).frames == 20
    assert (RecordedMission(path)["held/AvoidCollision"][:, :6] == 3).all()
    many = begun(TeamVectorEnv(2, mission=short, record=RecordSettings(tmp_path / "many")), seed=1)
    for _ in range(6):
        many.step(many.action_space.sample())
    many.close()
    lengths = sorted(RecordedMission(path).frames for path in (tmp_path / "many").iterdir())
    assert lengths == [10, 10, 20, 20]
    assert sum(RecordedMission(path).result is None for path in (tmp_path / "many").iterdir()) == 2


def test_minds_need_worlds_that_note_reasons(tmp_path):
    course = course_of(MISSION, 3, 17)
    with pytest.raises(ValueError, match="minds: expected worlds with explained=True"):
        MissionRecorder(course.worlds, replace(RecordSettings(tmp_path), minds=True))
