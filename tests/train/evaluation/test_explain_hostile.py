"""`clean-swarm explain` with recordings that are damaged or of something else, and with few, many and still robots."""

import json
import re
import shutil
import struct

import numpy as np
import pytest

from clean_swarm_env.recording import file as recording_file
from clean_swarm_env.recording.file import CLOSING, HEAD, MAGIC, blocks_of
from clean_swarm_env.recording.reader import RecordedMission
from tests.train.commands import command, done, refused
from train.evaluation.explain import largest_turns

ROBOT = ("--robot", 2)
AT = ("--time", 4.0)
REPEATED = "run again: "


def written(blocks, version=1) -> bytes:
    """The bytes of a recording of blocks."""
    return MAGIC + struct.pack("<I", version) + b"".join(recording_file._block(*block) for block in blocks)


def with_head(data, change) -> bytes:
    """The bytes of a recording whose head is changed."""
    head = json.loads(data[0][1])
    change(head)
    return written([(HEAD, json.dumps(head).encode()), *data[1:]])


def channel_to(name, /, **changes):
    """Return what changes a channel in a head."""
    return lambda head: next(one for one in head["channels"] if one["name"] == name).update(changes)


def results(folder, mission, *words):
    """Results of one short mission."""
    experiment = {"name": "short", "mission": {"base": "table1", **mission}, "conditions": [{"name": "one"}]}
    (folder / "short.yaml").write_text(json.dumps(experiment))
    done("evaluate", folder / "short.yaml", "--scenarios", 1, "--workers", 1, *words, "--output", folder / "run")
    return folder / "run"


@pytest.fixture(scope="module")
def evaluated(tmp_path_factory):
    """Results with a recording, and the blocks of this."""
    run = results(tmp_path_factory.mktemp("hostile"), {"time_limit": 20.0}, "--minds")
    (path,) = (run / "recordings").iterdir()
    return run, path.name, list(blocks_of(path))


CUT = "cut: the run is repeated"
FILES = {
    "empty": (lambda data: b"", "got another kind of file"),
    "a text": (lambda data: b"robot,time\n" * 99, "got another kind of file"),
    "its begin": (lambda data: written(data)[:10], "got another kind of file"),
    "its half": (lambda data: written(data)[: len(written(data)) // 2], CUT),
    "without its last bytes": (lambda data: written(data)[:-3], CUT),
    "only its head": (lambda data: written(data[:1]), CUT),
    "no frame": (lambda data: written([data[0], data[-1]]), CUT),
    "an older version": (lambda data: written(data, 0), "expected a recording of version 1, got version 0"),
    "a newer version": (lambda data: written(data, 2), "expected a recording of version 1, got version 2"),
    "a byte that changed": (lambda data: written(data)[:40] + b"?" + written(data)[41:], "the checksum of the block"),
    "twice": (lambda data: written(data) * 2, "expected a block, got"),
    "a result that is none": (lambda data: written([*data[:-1], (CLOSING, b"[]")]), "expected an object, got []"),
    "four robots": (
        lambda data: with_head(data, lambda head: head.update(robots=4)),
        "expected the length of all axes",
    ),
    "no period": (lambda data: with_head(data, lambda head: head.update(period=0.0)), "head: period: expected"),
    "of another run": (lambda data: with_head(data, lambda head: head.update(about={})), CUT),
    "other channels": (
        lambda data: with_head(data, channel_to("command_x", name="x_of_it")),
        "channels: expected command_x with an axis robot, got none",
    ),
    "other axes": (
        lambda data: with_head(data, channel_to("command_y", axes=["slot"])),
        "channels: expected command_y with an axis robot, got none",
    ),
}


@pytest.mark.parametrize("kind", FILES)
def test_a_recording_that_is_none_is_one_line_and_at_a_time_the_run_is_repeated(evaluated, tmp_path, kind):
    source, name, data = evaluated
    make, expected = FILES[kind]
    run = shutil.copytree(source, tmp_path / "run")
    (run / "recordings" / name).write_bytes(make(data))
    if expected == CUT:
        code, told, said = command("explain", run, *ROBOT)
        assert (code, said.startswith(REPEATED)) == (0, True)
        assert told == done("explain", source, *ROBOT)
    else:
        line = refused("explain", run, *ROBOT)
        assert line.startswith(f"error: {run / 'recordings' / name}: ")
        assert expected in line
    assert done("explain", run, *ROBOT, *AT) == done("explain", source, *ROBOT, *AT)


@pytest.mark.parametrize("time", ["nan", "inf", "-inf", "-1", "-1e-9", "-1e308"])
def test_a_time_that_is_none_is_refused_before_anything_runs(evaluated, monkeypatch, time):
    monkeypatch.delattr("train.evaluation.repeat.task_of")
    assert f"--time: expected seconds from 0 on, got {float(time):g}\n" in refused(
        "explain", evaluated[0], *ROBOT, f"--time={time}"
    )


@pytest.mark.parametrize("time", ["20.0", "1e9", "1e18", "1e308", "1.7976931348623157e308"])
def test_a_time_after_the_end_says_when_that_was(evaluated, time):
    line = refused("explain", evaluated[0], *ROBOT, "--time", time)
    assert re.fullmatch(r"error: --time \S+: this mission .* 20 s\n", line)


@pytest.mark.parametrize("time", ["0", "-0.0", "5e-324", "0.19999", "19.8", "19.99"])
def test_each_time_of_the_mission_is_in_the_step_that_it_lies_in(evaluated, time):
    told = json.loads(done("explain", evaluated[0], *ROBOT, f"--time={time}", "--json"))
    assert told["step"] == int(float(time) * 5 + 1e-6)


@pytest.mark.parametrize("words", [(), AT])
def test_folders_without_results_and_other_files_are_one_line(tmp_path, evaluated, words):
    (tmp_path / "text.txt").write_text("no results")
    assert "expected a directory of results, got a file" in refused("explain", tmp_path / "text.txt", *ROBOT, *words)
    (tmp_path / "empty").mkdir()
    assert "has no manifest.json; expected the results of an" in refused("explain", tmp_path / "empty", *ROBOT, *words)
    run = shutil.copytree(evaluated[0], tmp_path / "run")
    (run / "runs.jsonl").write_text("")
    assert refused("explain", run, *ROBOT, *words) == f"error: {run}: has no finished run\n"
    (run / "runs.jsonl").write_text("no JSON\n")
    assert "runs.jsonl: line 1: " in refused("explain", run, *ROBOT, *words)


@pytest.mark.parametrize(
    "mission",
    [
        {"robots": {"count": 1}, "time_limit": 10.0},
        {"robots": {"count": 1}, "time_limit": 0.2},
        {"robots": {"count": 300}, "world": {"width": 60.0, "height": 60.0}, "time_limit": 2.0},
    ],
)
def test_one_robot_many_robots_and_one_tick_are_explained(tmp_path, mission):
    run, last = results(tmp_path, mission, "--minds"), mission["robots"]["count"] - 1
    (path,) = (run / "recordings").iterdir()
    turns = json.loads(done("explain", run, "--robot", last, "--json"))
    assert turns == largest_turns(RecordedMission(path), last)
    assert len(turns) <= 8
    assert all(np.isfinite(list(one.values())).all() for one in turns)
    end = mission["time_limit"] - 0.2
    told = json.loads(done("explain", run, "--robot", last, "--time", end, "--json"))
    assert (told["robot"], told["step"]) == (last, round(end * 5))
    assert f"--robot: expected a number from 0 to {last}, got {last + 1}" in refused(
        "explain", run, "--robot", last + 1
    )
