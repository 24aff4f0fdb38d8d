"""Missions of every task are recorded, and shown from their recordings as they were."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.task_names import task_names
from clean_swarm_env.config.tasks import CLEANING, find_task
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.drawing.canvases import RecordedCourse, canvas_of
from clean_swarm_env.recording.reader import Happened, events_of, tables_of
from clean_swarm_env.tasks import Shown
from clean_swarm_env.world.explaining import explain_robot
from clean_swarm_env.world.mission import result_of
from tests.clean_swarm_env.courses import course_of, recorded, run_recorded, ticked
from tests.clean_swarm_env.recording.shepherding import with_shepherding
from train.replay.page_file import page_of

TASKS = [*(name for name in task_names() if name != CLEANING), "Shepherding"]


def course_at(task, explained=False, **changes):
    return course_of(MissionConfig.model_validate({"task": task, **changes}), 3, 4, explained=explained)


def played(task, folder, minds=False, **changes):
    """Run a mission; return its recording, its course, and the canvas and the poses before each control period."""
    course = course_at(task, minds, **changes)
    seen = lambda: (canvas_of(course.worlds, 0), course.worlds.physics.positions.copy())  # noqa: E731
    recording, told = recorded(course, folder, seen, minds=minds)
    return recording, course, [canvas for canvas, _ in told[:-1]], np.array([places for _, places in told[:-1]])


@pytest.fixture(autouse=True)
def _shepherding(monkeypatch):
    with_shepherding(monkeypatch)


@pytest.mark.parametrize("task", TASKS)
def test_a_recording_holds_the_course_the_things_and_the_measures(tmp_path, task):
    recording, course, canvases, places = played(task, tmp_path, minds=True, time_limit=4.0)
    head, mission = recording.head, course.worlds.mission
    assert np.allclose(np.stack([recording["x"], recording["y"]], axis=-1), places, atol=0.0005001)
    assert (head["width"], head["height"], head["ground"]) == (*mission.extent, mission.world.ground)
    assert not [name for name in recording if name.startswith(("item_", "station_", "recycled"))]
    assert ("cargo" in recording) == (task == "Foraging")
    assert recording.result == json.loads(json.dumps(result_of(course.worlds, 0).as_mapping()))
    assert list(recording.result["measures"]) == [measure.name for measure in course.worlds.task.measures]
    assert all(f"held/{goal}" in recording for goal in head["options"])
    assert (recording["robot/running"] == 1).any()
    shown = RecordedCourse(recording)
    for frame in (0, 7, 19):
        now, then = shown.at(frame * recording.period), canvases[frame]
        assert ((now.positions >= 0.0) & (now.positions <= now.width)).all()
        assert [area.name for area in now.areas] == [area.name for area in then.areas]
        middles = [np.array([[area.x, area.y] for area in one.areas]).reshape(-1, 2) for one in (now, then)]
        offsets = [one.positions[:1] - middle for one, middle in zip((now, then), middles, strict=True)]
        assert np.allclose(*offsets, atol=0.002)  # of open land another part may be shown
    assert tables_of(recording)["robot"]["x"].size == recording["x"].size
    assert page_of([recording])


def test_things_that_move_are_where_they_were(tmp_path):
    course = course_at("Shepherding", time_limit=10.0)
    recording, seen = recorded(course, tmp_path, lambda: course.worlds.task.state.places[0].copy())
    found = np.stack([recording["thing_x"], recording["thing_y"]], axis=-1)
    assert np.allclose(found, seen[:-1], atol=0.0005001)
    assert np.abs(found[-1] - found[0]).max() > 0.5
    assert [(thing["channel"], thing.get("moves")) for thing in recording.head["things"]] == [
        ("ring", None),
        *(("sheep", k) for k in range(4)),
    ]
    assert set(tables_of(recording)["thing"]) == {"frame", "time", "thing", "thing_x", "thing_y"}


def test_food_that_robots_carry_is_their_cargo(tmp_path):
    recording, _, canvases, _ = played("Foraging", tmp_path, time_limit=90.0)
    picked, brought = (np.diff(recording["cargo"], axis=0) == step for step in (1, -1))
    assert picked.sum() >= brought.sum() > 0
    assert [kind["channel"] for kind in recording.notes["deposits"]] == ["trail"]
    shown = RecordedCourse(recording).at(recording.times[-1])
    assert sorted(area.name for area in shown.areas) == ["food", "food", "nest"]
    assert not any(area.repels for area in shown.areas)
    assert len(canvases[-1].pheromones) > 10
    assert len(shown.pheromones) > 10
    assert max(canvas.load.max() for canvas in canvases) == 0
    assert canvases[-1].state.startswith("items brought per minute ")


def test_events_of_a_task_are_recorded_and_listed_with_their_robots(tmp_path):
    recording, course, _, _ = played("Foraging", tmp_path, time_limit=90.0)
    events, puts = events_of(recording), np.argwhere(np.diff(recording["brought"], axis=0) > 0)
    assert len(events) == course.worlds.task.state.brought[0] > 0
    assert events == [Happened(recording.times[k + 1], "item brought", "robot", robot) for k, robot in puts]
    course = course_of(load_mission("bumpers"), 3, 4)
    recording, told = recorded(course, tmp_path, lambda: course.worlds.task.consequences.collisions.copy())
    stopped = {(one.event, one.number) for one in events_of(recording)}
    assert stopped == {("stopped by a collision", robot) for robot in np.flatnonzero(told[-1]).tolist()} != set()


def test_what_happens_in_the_first_period_is_an_event_too_and_the_task_says_the_order():
    counts = {"rang": np.array([[1, 0], [1, 1]]), "ended": np.array([[0, 0], [1, 1]])}
    channel, events = (
        SimpleNamespace(axes=("alarm",)),
        [{"of": "rang", "event": "rings"}, {"of": "ended", "event": "ends"}],
    )
    kept = {"head": {"events": events}, "channels": dict.fromkeys(counts, channel), "times": np.array([0.2, 0.4])}
    told = [(one.time, one.event, one.number) for one in events_of(SimpleNamespace(**kept, whole=counts.get))]
    assert told == [(0.2, "rings", 0), (0.4, "rings", 1), (0.4, "ends", 0), (0.4, "ends", 1)]


def test_contacts_and_obstacles_are_shown(tmp_path):
    recording, course, canvases, _ = played("CollisionAvoidance", tmp_path, time_limit=20.0)
    assert {area.name for area in canvases[0].areas if area.repels} == {"obstacle"}
    assert recording["contact"].sum() == 2 * course.worlds.world.collisions[0]


def test_a_recording_that_lacks_the_things_that_move_is_refused_by_name(tmp_path):
    recording = played("Shepherding", tmp_path, time_limit=1.0)[0]
    del recording.channels["thing_x"]
    with pytest.raises(ConfigurationError, match="expected channel thing_x with a number for each thing"):
        RecordedCourse(recording)


def test_a_robot_of_any_task_is_explained():
    step = explain_robot(ticked(course_at("Foraging", True), 10).worlds, 3)
    assert step.options["Foraging"]
    assert [behaviour.name for behaviour in step.network.behaviours] == ["Foraging"]
    assert step.coordinators[0].inner is not None


@pytest.mark.parametrize(
    ("name", "kept", "said"),
    [("load", False, "a new one of load"), ("heading", True, "no other channel .* got heading")],
)
def test_what_a_recording_cannot_keep_is_one_line_that_names_the_task(name, kept, said, tmp_path, monkeypatch):
    task, turns = find_task("Shepherding"), np.zeros(6, dtype=np.int64)
    monkeypatch.setattr(task, "shown", lambda self: (Shown(name, "robot", turns if kept else turns.copy(), "turns"),))
    with pytest.raises(ValueError, match=f"Shepherding.shown: expected .*{said}"):
        run_recorded(MissionConfig.model_validate({"task": "Shepherding", "time_limit": 1.0}), 3, 4, tmp_path)


def test_a_shown_array_that_becomes_another_one_while_it_is_recorded_is_one_line(tmp_path, monkeypatch):
    def grow(self):
        self.turns = np.append(self.turns, 0)

    task = find_task("Shepherding")
    monkeypatch.setattr(task, "turns", np.zeros(6, dtype=np.int64), raising=False)
    monkeypatch.setattr(task, "shown", lambda self: (Shown("load", "robot", self.turns, "turns"),))
    monkeypatch.setattr(task, "after_moving", grow)
    with pytest.raises(ValueError, match=r"Shepherding.shown: expected the same array .* of load"):
        run_recorded(MissionConfig.model_validate({"task": "Shepherding", "time_limit": 1.0}), 3, 4, tmp_path)
