"""A robot whose document lets a network inside a behaviour decide how to search, in a mission."""

import json

import numpy as np
import pytest
import yaml

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.learning.batch import mission_begun
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.find import SHIPPED
from tests.clean_swarm_env.courses import mission, ticked
from train.evaluation.explain import as_json, explained
from train.evaluation.repeat import record_run
from train.running.trial_task import TrialTask

PATROL = {"channels": ["pheromone"], "pheromone": {"channel": "pheromone", "attraction": -1}, "min_speed": 0.5}
SEARCH = {
    "mechanisms": {"go": {"type": "Patrol", "buffer": "pheromones", "parameters": PATROL}},
    "knowledge": {"roamed": False},
    "sensors": {"garbage_found": "fact", "roamed": {"type": "Known", "name": "roamed"}},
    "conditions": {"roamed": {"sensor": "roamed", "activator": {"type": "Boolean"}}},
    "behaviours": {
        "Roam": {
            "action": [{"type": "Move", "mechanism": "go"}, {"type": "SetState", "name": "roamed", "value": True}]
        },
        "Pause": {"preconditions": ["roamed"], "network": "pause"},
    },
}
IDLE = {"sensors": {"garbage_found": "fact"}, "behaviours": {"Rest": {}}}
PAUSE = {"sensors": {"roamed": "fact"}, "behaviours": {"Rest": {"preconditions": ["roamed"]}}}


@pytest.fixture
def robot(tmp_path):
    """Write the shipped robot with Search in place of Patrol: the network in it searches, or leaves the robot alone."""

    def write(nested):
        document = yaml.safe_load((SHIPPED / "robots" / "cleaning.yaml").read_text())
        behaviours = document["networks"]["robot"]["behaviours"]
        search = behaviours.pop("Patrol") | {"network": "search"}
        document["networks"]["robot"]["behaviours"] = {"Search": search, **behaviours}
        document["networks"] |= {"search": SEARCH, "pause": PAUSE} if nested else {"search": IDLE}
        (tmp_path / "robots").mkdir(exist_ok=True)
        (tmp_path / "robots" / "searching.yaml").write_text(yaml.safe_dump(document, sort_keys=False))
        return tmp_path

    return write


MISSION = mission(network={"robot": "searching"}, time_limit=20.0)


def course_of(directory):
    return mission_begun(MISSION, random_start(MISSION, 5, 0), 3, directories=(directory,))


def searching(course, ticks):
    """Return whether each robot searched in each tick, and how far it went in these ticks."""
    network, searched = course.worlds.network, []
    column, way = network.model.behaviour_index["Search"], np.zeros(5)
    for _ in range(ticks):
        before = course.worlds.physics.positions.copy()
        course.tick()
        searched.append(network.executing[:, column] == 1)
        way += np.hypot(*(course.worlds.physics.positions - before).T) * searched[-1]
    return np.array(searched), way


def test_what_lies_in_a_behaviour_moves_the_robots(robot):
    searched, way = searching(course_of(robot(nested=False)), 30)
    only = searched.sum(axis=0) >= 29
    assert only.any()
    assert (way[only] == 0.0).all()
    course = course_of(robot(nested=True))
    searched, way = searching(course, 30)
    assert (way[searched.sum(axis=0) > 20] > 1.0).all()
    assert (searched.sum(axis=0) > 20).any()
    search, pause = course.worlds.minds.nested
    roams = search.network.executing[:, 0] == 1
    assert np.array_equal(roams, searched[-1])
    assert np.array_equal(pause.network.executing[:, 0] == 1, search.network.executing[:, 1] == 1)
    assert course.worlds.minds.buffers["pheromones"].count(0, "pheromone") > 0


def test_a_robot_that_begins_anew_begins_anew_inside(robot):
    course = ticked(course_of(robot(nested=True)), 10)
    course.worlds.minds.reset_rows(np.array([1]))
    for inner in course.worlds.minds.nested:
        assert not inner.network.executing[1].any()
        assert not inner.network.readings[1].any()


def test_explanations_and_recordings_show_what_lies_inside(robot, tmp_path):
    start = random_start(MISSION, 5, 0)
    one = Scenario(start.id, run_seed(3, start.id), MISSION, start)
    task = TrialTask("mine", 3, (one,), "c", "MaxScore", directories=(robot(nested=True),))
    shown = json.loads(as_json(*explained(task, tmp_path / "until.swarm", 0, 4.0)))
    record_run(task, tmp_path / "run.swarm")
    recording = RecordedMission(tmp_path / "run.swarm")
    assert [one["title"] for one in shown["networks"]] == ["Search", "Search/Pause"]
    (running,) = [b for b in shown["behaviours"] if b["name"] == "Search"]
    assert (shown["networks"][0]["inner"] is not None) == running["running"]
    assert recording.head["networks"]["Search"]["behaviours"] == ["Roam", "Pause"]
    assert "Search/Pause" in recording.head["networks"]
    assert recording["Search/values"].shape == (recording.frames, 5, 9, 2)
    assert recording["Search/running"].any()
