"""The canvas of a recording is that of the world that was recorded, at every moment and between two."""

from dataclasses import replace

import numpy as np
import pytest

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.drawing.canvases import RecordedCourse, canvas_of, pictured
from clean_swarm_env.drawing.picture import TITLE, pixels_of
from clean_swarm_env.learning.given import mission_from
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.errors import validated
from tests.clean_swarm_env.courses import course_of, mission, recorded, run_recorded
from tests.clean_swarm_env.world.test_models import team

EVENTS = [{"at": 20.0, "do": "fail", "robots": [1]}, {"at": 30.0, "do": "join", "robots": 2}]
MISSION = mission_from({"base": "table1", "time_limit": 150.0, "events": EVENTS, "task": {"garbage": {"count": 8}}})


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """Canvases of a world at the start and after each tick, and the recording of it."""
    course = course_of(MISSION, 1, 2)
    recording, canvases = recorded(course, tmp_path_factory.mktemp("seen"), lambda: canvas_of(course.worlds, 0))
    return canvases, recording


def test_every_moment_is_as_it_was(seen):
    canvases, recording = seen
    course = RecordedCourse(recording)
    assert course.end == pytest.approx(149.8)
    for tick in range(1, recording.frames, 7):
        before, now = canvases[tick], course.at(tick * recording.period)
        decided = course.at((tick - 1) * recording.period)  # what is decided in a period is seen after it
        if len(now.positions) == len(before.positions):
            assert np.allclose(now.positions, before.positions, atol=0.001)
            assert np.allclose(now.headings, before.headings, atol=0.001)
        for own, other in zip(decided.signs, before.signs, strict=True):
            assert (own.sign, own.radius) == (other.sign, other.radius)
            assert np.allclose(own.places, other.places, atol=0.001)
        for name in ("load", "held", "working"):
            assert np.array_equal(getattr(decided, name), getattr(before, name)), (tick, name)
        assert decided.state.endswith(before.state)
        assert (now.options, now.radius) == (before.options, before.radius)
        assert now.time == pytest.approx(before.time)
    assert {int(load) for canvas in canvases for load in canvas.load} == {-1, 0, 1}
    assert sorted({len(canvas.positions) for canvas in canvases}) == [5, 7]


def test_between_two_frames_robots_have_moved_a_share_of_the_way(seen):
    _, recording = seen
    course = RecordedCourse(recording)
    first, middle, second = (course.at(time) for time in (10.0, 10.05, 10.2))
    assert middle.time == pytest.approx(10.05)
    way, part = ((b.positions - first.positions + 5.5) % 11.0 - 5.5 for b in (second, middle))
    assert np.allclose(part, 0.25 * way, atol=1e-9)
    assert np.abs(way).max() > 0.05


def test_a_recording_without_robots_or_items_is_refused_by_name(seen):
    _, recording = seen
    lacking = RecordedMission(recording.path)
    del lacking.channels["cargo"]
    with pytest.raises(ConfigurationError, match="expected channel cargo with a number for each robot, got shape None"):
        RecordedCourse(lacking)


@pytest.mark.parametrize("drawn", [7, [["item", "unicorn"]], [{"at": "item"}]])
def test_a_head_with_signs_that_do_not_exist_is_one_line(seen, drawn):
    head = {**seen[1].head, "drawn": drawn}
    with pytest.raises(ConfigurationError, match=r"^head: drawn") as refused:
        pictured(head)
    assert "\n" not in str(refused.value)


STANDING = {
    "walls": mission("three-rooms", time_limit=4.0),
    "zones": mission("silent-zone", time_limit=4.0),
    "models": team(time_limit=4.0),
    "stations": mission("transport", time_limit=4.0),
}


@pytest.mark.parametrize("kind", STANDING)
def test_what_stands_in_a_mission_is_drawn_from_its_recording_as_from_its_world(kind, tmp_path):
    recording = run_recorded(STANDING[kind], 1, 3, tmp_path)
    assert validated(MissionConfig, recording.head["mission"], "head") == STANDING[kind]
    shown, now = RecordedCourse(recording).at(0.0), canvas_of(course_of(STANDING[kind], 1, 3).worlds, 0)
    for name in ("width", "height", "closed", "zones", "model_names", "loads"):
        assert getattr(shown, name) == getattr(now, name), name
    for name in ("walls", "radius", "models"):
        assert np.array_equal(getattr(shown, name), getattr(now, name)), name
    assert len(shown.walls) == {"walls": 8, "zones": 0}.get(kind, 0)
    assert (shown.models is not None) == (kind == "models")
    assert shown.zones[1:] == ((("mud", 11.0, 2.0, 16.0, 9.0),) if kind == "zones" else ())
    for own, other in zip(shown.signs, now.signs, strict=True):
        assert np.allclose(own.places, other.places, atol=0.001)
    bare = replace(now, walls=now.walls[:0], zones=(), radius=now.radius + 0.1, signs=())
    assert not np.array_equal(pixels_of(now)[TITLE:], pixels_of(bare)[TITLE:])
