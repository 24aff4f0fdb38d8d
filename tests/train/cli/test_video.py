"""`clean-swarm video` and `picture`: files that are what was asked for, and one line for what cannot be."""

import os
import shutil
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.drawing.canvas import Canvas
from clean_swarm_env.drawing.canvases import RecordedCourse
from clean_swarm_env.drawing.look import OPTION_COLOURS
from clean_swarm_env.drawing.picture import pixels_of
from clean_swarm_env.drawing.video import write_video
from clean_swarm_env.recording.reader import RecordedMission
from tests.clean_swarm_env.courses import run_recorded
from tests.train.commands import done, refused
from train.cli import look
from train.running import needs


def recording(folder, seconds):
    """Record a mission of so many seconds and return the file."""
    mission = load_mission("table1").model_copy(update={"time_limit": seconds})
    return run_recorded(mission, 1, 2, folder).path


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    return recording(tmp_path_factory.mktemp("recorded"), seconds=6.0)


@pytest.fixture
def copied(recorded, tmp_path, monkeypatch):
    """Be in a directory with nothing but the recording."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(recorded, "run.swarm")
    return tmp_path


@pytest.mark.parametrize("suffix", ["webp", "gif"])
def test_a_video_has_twenty_pictures_a_second_of_the_run(recorded, tmp_path, suffix):
    output = tmp_path / "new" / f"out.{suffix}"
    out = done("video", recorded, output, "--from", 1, "--to", 3, "--size", 200)
    assert out == f"{output}: 41 pictures, 2.05 s\n"
    shown = Image.open(output)
    assert (shown.n_frames, shown.info["loop"]) == (41, 0)
    course = RecordedCourse(RecordedMission(recorded))
    shown.seek(20)
    pixels = np.asarray(shown.convert("RGB")).astype(float)
    assert shown.info["duration"] == 50
    own, other = (np.abs(pixels - pixels_of(course.at(time), 200)).mean() for time in (2.0, 3.0))
    assert own < 4.0
    assert own < 0.8 * other
    assert "30 pictures" in done("video", recorded, output, "--speed", 4, "--size", 200)
    assert [path.name for path in output.parent.iterdir()] == [output.name]


def test_a_run_becomes_a_video_of_thirty_seconds_unless_a_speed_is_given(recorded, tmp_path, monkeypatch):
    monkeypatch.setattr(look, "USUAL_LENGTH", 2.0)  # of the 5.8 s, as 30 s of a whole mission
    output = tmp_path / "out.webp"
    words = ("video", recorded, output, "--size", 200)
    assert done(*words) == f"{output}: 39 pictures, 1.95 s, 3 times as fast as the mission (--speed)\n"
    assert done(*words, "--to", 1.5) == f"{output}: 31 pictures, 1.55 s\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("look", "picture", "run.swarm", "a.png", "--time", 1),
            "run.swarm: expected at most 8 numbers, for the memory, got more",
        ),
        (("video", "run.swarm", "a.webp"), "run.swarm: expected at most 8 numbers, for the memory, got more"),
        (("replay", "run.swarm", "--html", "a.html"), "a.html: a page of "),
    ],
)
def test_what_this_machine_is_too_small_for_is_refused_before_it_begins(copied, words, message, monkeypatch):
    monkeypatch.setattr(needs, "memory_of_machine", lambda: needs.PROCESS + 100.0)
    monkeypatch.setattr(needs, "disk_usage", lambda place: SimpleNamespace(free=1000))
    line = refused(*words)
    assert line.startswith(f"error: {message}")
    assert "expected at most" in line
    assert os.listdir(copied) == ["run.swarm"]


def test_a_gif_keeps_the_colours_of_options(tmp_path):
    rows = np.arange(len(OPTION_COLOURS))
    positions = np.stack([1.0 + rows, np.full(len(rows), 5.0)], axis=1)
    canvas = Canvas(positions, np.zeros(len(rows)), options=OPTION_COLOURS, held=rows)
    picture = pixels_of(canvas)
    write_video(tmp_path / "a.gif", iter([picture, picture]))
    shown = np.asarray(Image.open(tmp_path / "a.gif").convert("RGB"))
    for colour in OPTION_COLOURS:
        there = (picture == list(bytes.fromhex(colour[1:]))).all(axis=-1)
        assert there.sum() > 100
        assert np.array_equal(shown[there], picture[there]), colour


@pytest.mark.parametrize("suffix", ["svg", "png", "webp"])
def test_a_picture_is_the_moment_that_was_asked_for(recorded, tmp_path, suffix):
    output = tmp_path / f"out.{suffix}"
    done("look", "picture", recorded, output, "--time", 2.5, "--size", 300)
    if suffix == "svg":
        assert ElementTree.parse(output).getroot().get("viewBox").startswith("0 0 300 ")
    else:
        expected = pixels_of(RecordedCourse(RecordedMission(recorded)).at(2.5), 300)
        assert np.array_equal(np.asarray(Image.open(output).convert("RGB")), expected)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("look", "picture", "run.swarm", "a.jpeg", "--time", 1),
            "a.jpeg: expected a name that ends with .svg, .png, .webp",
        ),
        (("look", "picture", "run.swarm", "a.svg", "--time", 6), "--time: expected seconds from 0 to 5.8, got 6"),
        (("look", "picture", "run.swarm", "a.svg", "--time", "nan"), "--time: expected seconds from 0 to 5.8, got nan"),
        (
            ("look", "picture", "run.swarm", "a.svg", "--time", 1, "--size", 9999),
            "--size: expected a whole number of at most 4000",
        ),
        (
            ("video", "run.swarm", "a.mp4"),
            "a.mp4: expected a name that ends with .webp, .gif; of a .gif, ffmpeg makes other",
        ),
        (("video", "run.swarm", "a.webp", "--from", 3, "--to", 2), "--to: expected at least --from, 3, got 2"),
        (("video", "run.swarm", "a.webp", "--speed", 0), "--speed: expected a positive number up to 1000, got 0"),
        (
            ("video", "run.swarm", "a.gif", "--speed", 1e-9),
            "a.gif: 116000000001 pictures: expected at most 7.0 days of time, got about",
        ),
        (
            ("video", "run.swarm", "a.webp", "--speed", 0.0001, "--size", 4000),
            "a.webp: 1160001 pictures: expected at most 7.0 days of time, got about",
        ),
        (("video", "run.swarm", "run.swarm/a.webp"), "run.swarm/a.webp: cannot be written (File exists)"),
        (("video", "nowhere", "a.webp"), "nowhere: cannot be read (No such file or directory)"),
    ],
)
def test_what_cannot_be_is_one_line(copied, words, message):
    assert refused(*words).startswith(f"error: {message}")
    assert os.listdir(copied) == ["run.swarm"]


def test_a_truncated_recording_is_shown_as_far_as_it_goes(tmp_path):
    path = recording(tmp_path, seconds=120.0)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) * 3 // 4])
    words = ("look", "picture", path, tmp_path / "a.png", "--time")
    done(*words, 10)
    assert "--time: expected seconds from 0 to" in refused(*words, 119)
