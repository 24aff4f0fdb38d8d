"""`clean-swarm explain` and `record`: a run repeated with explained robots takes the same course and tells why."""

import json
import shutil
from functools import reduce
from operator import getitem
from pathlib import Path

import numpy as np
import pytest

from clean_swarm_env.config.starts import run_seed
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.batch import mission_begun
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.world.explaining import explain_robot
from clean_swarm_env.world.mission import MissionResult
from tests.clean_swarm_env.courses import difference, snapshot
from tests.train.commands import changed, command, done, refused
from train.evaluation.repeat import steps_of, task_of
from train.evaluation.why import facts_of, sentence

CONDITIONS = [
    {"name": name, "scores": {"AvoidCollision": {name: 2.0}}}
    for name in ("RepulsionFernandez-view2.0", "RepulsionGradient-view1.5")
]


def evaluation(directory, mission, conditions, *words) -> Path:
    """Run an evaluation of a changed mission of Table 1 and return its results."""
    experiment = {"name": "short", "mission": {"base": "table1", **mission}, "conditions": conditions}
    (directory / "short.yaml").write_text(json.dumps(experiment))
    done("evaluate", directory / "short.yaml", *words, "--workers", 1, "--output", directory / "run")
    return directory / "run"


@pytest.fixture(scope="module")
def evaluated(tmp_path_factory) -> Path:
    """Results of four short missions: two of five robots and two items, with either condition."""
    mission = {"task": {"garbage": {"count": 2}}}
    return evaluation(tmp_path_factory.mktemp("results"), mission, CONDITIONS, "--scenarios", 2, "--seed", 5)


@pytest.fixture(scope="module")
def changing(tmp_path_factory) -> Path:
    """Results of a short mission in which robot 5 joins, robot 1 fails and robot 2 is taken away."""
    events = [
        {"at": 2.0, "do": "join", "places": [[5.0, 1.0, 0.5]]},
        {"at": 3.0, "do": "fail", "robots": [1]},
        {"at": 4.0, "do": "remove", "robots": [2]},
    ]
    mission = {"events": events, "time_limit": 8.0}
    return evaluation(tmp_path_factory.mktemp("changing"), mission, CONDITIONS[:1], "--scenarios", 1)


@pytest.fixture(autouse=True)
def narrow(monkeypatch):
    """Have a terminal of 80 columns."""
    monkeypatch.setenv("COLUMNS", "80")


def test_an_explained_run_takes_the_same_course_bit_for_bit(evaluated):
    for condition in ("RepulsionFernandez-view2.0", "RepulsionGradient-view1.5"):
        task = task_of(evaluated, "2", condition)
        plain = mission_begun(task.first.mission, task.first.start, run_seed(5, "2"))
        for explained, *_ in steps_of(task):
            assert not plain.over[0]
            plain.tick()
            assert difference([snapshot(plain.worlds, 0)], [snapshot(explained.worlds, 0)]) == ""
        assert plain.over[0]


@pytest.mark.parametrize("time", [0.0, 0.2, 7.0, 30.0])
def test_how_long_a_robot_has_stayed_and_done_what_it_does_is_told(evaluated, time):
    task, step = task_of(evaluated), round(time / 0.2)
    course = mission_begun(task.first.mission, task.first.start, run_seed(5, "1"))
    places, runs = [np.array(task.first.start.robots)[:, :2]], []
    while len(runs) <= step:
        course.tick()
        places.append(course.worlds.physics.positions.copy())
        runs.append(course.worlds.network.executing == 1)
    names = [behaviour.name for behaviour in course.worlds.network.model.behaviours]
    for robot in range(5):
        way = np.abs([place[robot] - places[step][robot] for place in places[: step + 1]])
        away = np.hypot(*np.minimum(way, course.worlds.extent - way).T) >= 0.1
        since = max([-1, *(k for k in range(step + 1) if away[k])]) + 1
        shown = json.loads(done("explain", evaluated, "--robot", robot, "--time", time, "--json"))
        assert shown["stayed_s"] == pytest.approx((step - since) * 0.2)
        assert shown["running_s"].keys() == {name for b, name in enumerate(names) if runs[step][robot, b]}
        for name, seconds in shown["running_s"].items():
            began = max([-1, *(k for k in range(step + 1) if not runs[k][robot, names.index(name)])]) + 1
            assert seconds == pytest.approx((step - began + 1) * 0.2)


def test_without_a_time_the_largest_turns_of_a_robot_are_listed(evaluated, tmp_path):
    done("record", evaluated, "--output", tmp_path / "run.swarm")
    recording = RecordedMission(tmp_path / "run.swarm")
    told = np.stack([recording[f"command_{axis}"][:, 3] for axis in "xy"], axis=1)
    before, after = told[:-1], told[1:]
    sines = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns = np.degrees(np.arctan2(sines, (before * after).sum(axis=1)))
    moving = np.linalg.norm(told, axis=1) > 0.05
    turns[~(moving[:-1] & moving[1:])] = 0.0
    found = json.loads(done("explain", evaluated, "--robot", 3, "--json"))
    largest = max(found, key=lambda one: abs(one["turn_deg"]))
    assert abs(largest["turn_deg"]) == pytest.approx(np.abs(turns).max(), abs=0.1)
    assert 2 <= len(found) <= 8
    assert (np.diff([one["time_s"] for one in found]) >= 2.0 - 1e-9).all()
    for one in found:
        assert turns[round(one["time_s"] / 0.2) - 1] == pytest.approx(one["turn_deg"], abs=0.1)
    assert json.loads(done("explain", evaluated, "--robot", 3, "--time", largest["time_s"], "--json"))["robot"] == 3
    first, *lines = done("explain", evaluated, "--robot", 3).splitlines()
    assert first == "largest turns of robot 3; --time says why it turned:"
    sides = ["left" if one["turn_deg"] > 0 else "right" for one in found]
    assert [line.split()[-1] for line in lines] == sides
    assert [float(line.split()[0]) for line in lines] == [one["time_s"] for one in found]
    assert "--robot: expected a number from 0 to 4, got 5" in refused("explain", evaluated, "--robot", 5)
    assert "--what-if: expected --time beside it" in refused("explain", evaluated, "--robot", 3, "--what-if")


def test_robots_that_join_are_explained_from_then_on(changing):
    assert refused("explain", changing, "--robot", 5, "--time", 1.8) == (
        "error: robot 5: expected a robot that is in the team at 1.8 s; "
        "it joins at 2 s, or later if its place is not free\n"
    )
    line = refused("explain", changing, "--robot", 6, "--time", 1.0)
    assert line == "error: --robot: expected a number from 0 to 5, got 6\n"
    path = changing.parent / "run.swarm"
    done("record", changing, "--output", path)
    places = np.stack([RecordedMission(path)["x"][:, 5], RecordedMission(path)["y"][:, 5]], axis=1)
    for frame in (10, 11, 20, 39):
        step = json.loads(done("explain", changing, "--robot", 5, "--time", frame * 0.2, "--json"))
        near = np.linalg.norm(places[10:frame] - places[frame], axis=1) < 0.1
        since = max([-1, *np.flatnonzero(~near)]) + 1
        assert (step["robot"], step["state"]) == (5, "at work")
        assert step["stayed_s"] == pytest.approx((frame - 10 - since) * 0.2)
        assert all(0.2 <= seconds <= (frame - 9) * 0.2 + 1e-9 for seconds in step["running_s"].values())


def test_robots_that_are_not_at_work_are_said_to_be(changing):
    for robot, time, state, said in (
        (1, 2.8, "at work", ""),
        (1, 3.0, "failed", "it has failed: its body stays"),
        (2, 3.8, "at work", ""),
        (2, 4.0, "taken away", "it has been taken away"),
    ):
        words = ("explain", changing, "--robot", robot, "--time", time)
        assert json.loads(done(*words, "--json"))["state"] == state
        lines = done(*words).splitlines()
        assert not said or said in lines
        assert not said or not any("has run for" in line or "has stayed" in line for line in lines)


def test_a_step_is_a_table_and_a_tree_of_80_columns(evaluated):
    lines = done("explain", evaluated, "--robot", 3, "--time", 4.1).splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[0] == "short, seed 5, RepulsionFernandez-view2.0, scenario 1"
    assert lines[1].startswith("robot 3 at 4 s (step 20); AvoidCollision by RepulsionFernandez-view2.0")
    for name in ("Patrol", "MoveToGarbage", "PickGarbage", "MoveToRecycling", "Recycle", "MoveToDump", "Dump"):
        assert sum(line.lstrip("│├└─ *").startswith(f"{name}:") for line in lines) == 1


def test_the_last_step_is_the_one_that_dumps_the_last_item(evaluated):
    first = json.loads((evaluated / "runs.jsonl").read_text().splitlines()[0])
    end = first["duration_s"]
    words = ("--robot", 0, "--scenario", first["scenario"], "--condition", first["condition"])
    done("explain", evaluated, *words, "--time", end)
    line = refused("explain", evaluated, *words, "--time", end + 0.2)
    assert f"this mission was completed after {end:g} s" in line


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--scenario", "7"], "run: unknown scenario '7' (known: 1, 2; 2 in all)"),
        (
            ["--condition", "RepulsionGradiant"],
            "unknown condition 'RepulsionGradiant' (known: RepulsionFernandez-view2.0, ",
        ),
        (["--robot", "5"], "--robot: expected a number from 0 to 4, got 5"),
        (["--robot", "-1"], "--robot: expected a number from 0 to 4, got -1"),
        (["--time", "-1"], "--time: expected seconds from 0 on, got -1"),
        (["--time", "nan"], "--time: expected seconds from 0 on, got nan"),
        (["--time", "1e9"], "--time 1e+09: this mission was completed after "),
    ],
)
def test_what_does_not_exist_is_one_line(evaluated, words, expected):
    assert expected in refused("explain", evaluated, "--robot", 0, "--time", 1.0, *words)


FIRST = ("--robot", 0, "--time", 1)


def test_what_is_no_directory_of_results_is_refused(tmp_path):
    missing = f"error: {tmp_path / 'none'}: cannot be read (No such file or directory)\n"
    assert refused("explain", tmp_path / "none", *FIRST) == missing
    line = refused("explain", tmp_path, *FIRST)
    assert "has no manifest.json; expected the results of an evaluation" in line
    (tmp_path / "run.swarm").write_bytes(b"")
    line = refused("explain", tmp_path / "run.swarm", *FIRST)
    assert line == f"error: {tmp_path / 'run.swarm'}: expected a directory of results, got a file\n"


@pytest.mark.parametrize(
    ("manifest", "expected"),
    [
        ("{", "manifest.json: line 1: "),
        ("[]", "manifest.json: expected a mapping of keys, got list"),
        ("{}", "expected the manifest of an evaluation"),
        ('{"identity": {"learner": "ppo"}}', "expected the results of an evaluation, got those of a training"),
    ],
)
def test_a_manifest_of_something_else_is_refused(tmp_path, manifest, expected):
    (tmp_path / "manifest.json").write_text(manifest)
    assert expected in refused("explain", tmp_path, *FIRST)


@pytest.mark.parametrize(
    ("keys", "value", "expected"),
    [
        (
            ("identity", "files", "mechanisms/RepulsionGradient.yaml"),
            "0",
            "mechanisms/RepulsionGradient.yaml has changed since the evaluation",
        ),
        (
            ("identity", "document", "mission", "robots", "radius"),
            -1.0,
            "manifest.json: identity.document: mission.robots.radius: expected",
        ),
        (
            ("identity", "document", "mission", "time_limit"),
            1.0,
            "this mission ended uncompleted at its time limit of 1 s",
        ),
    ],
)
def test_a_manifest_that_was_changed_is_refused(evaluated, tmp_path, keys, value, expected):
    assert expected in refused("explain", changed(evaluated, tmp_path / "run", putting(keys, value)), *FIRST)


def putting(keys, value):
    """Return what puts a value into a tree of mappings."""
    *above, last = keys
    return lambda tree: reduce(getitem, above, tree).__setitem__(last, value)


def test_other_versions_and_the_last_step_before_the_time_limit_are_explained(evaluated, tmp_path):
    other = changed(evaluated, tmp_path / "other", putting(("versions", "numba"), "0.1"))
    code, _, err = command("explain", other, *FIRST)
    assert code == 0
    assert "the course may differ from the one then: numba 0.1, now " in err
    limit = ("identity", "document", "mission", "time_limit")
    done("explain", changed(evaluated, tmp_path / "short", putting(limit, 3.0)), "--robot", 0, "--time", 2.9)


def test_a_recording_holds_what_explain_says(evaluated, tmp_path):
    path = tmp_path / "run.swarm"
    out = done("record", evaluated, "--output", path, "--scenario", "2")
    recording = RecordedMission(path)
    assert recording.head["about"] == {
        "scenario": "2",
        "seed": run_seed(5, "2"),
        "experiment": "short",
        "condition": "RepulsionFernandez-view2.0",
    }
    assert out == f"{recording.frames} steps of 5 robots in {path}\n"
    held = next(r for r in map(json.loads, (evaluated / "runs.jsonl").open()) if r["scenario"] == "2")
    assert recording.result == {name: held[name] for name in MissionResult.__dataclass_fields__ if name != "measures"}
    assert recording.frames == held["ticks"]
    names = recording.head["networks"]["robot"]
    for frame, robot in ((0, 0), (40, 1), (recording.frames - 1, 4)):
        time = frame * recording.period
        step = json.loads(done("explain", evaluated, "--scenario", 2, "--robot", robot, "--time", time, "--json"))
        values = recording["robot/values"][frame, robot]
        for account in step["behaviours"]:
            b = names["behaviours"].index(account["name"])
            expected = [account["activation"], account["satisfaction"], *account["components"].values()]
            assert values[:, b] == pytest.approx(expected, abs=0.00051)
            assert recording["robot/running"][frame, robot, b] == account["running"]
            by = recording["robot/by"][frame, robot, b]
            words = recording.head["reasons"][recording["robot/reason"][frame, robot, b]]
            assert words.format(by=names["behaviours"][by]) == account["why"]
        length = recording["robot/plan_length"][frame, robot]
        plan = [names["behaviours"][b] for b in recording["robot/plan"][frame, robot, : max(length, 0)]]
        assert (plan if length >= 0 else None) == step["plan"]
        assert dict(zip(names["sensors"], recording["robot/readings"][frame, robot], strict=True)) == pytest.approx(
            step["readings"], abs=0.00051
        )
    for name, expected in (
        ("run.swarm", "exists already; expected a new file"),
        ("run.npz", "expected a name that ends with .swarm"),
        ("run.swarm/run.swarm", "cannot be written"),
    ):
        assert expected in refused("record", evaluated, "--output", tmp_path / name)


def test_a_running_coordinator_is_explained_from_inside(evaluated):
    for batch, *_ in steps_of(task_of(evaluated)):
        worlds = batch.worlds
        running = np.flatnonzero(worlds.network.executing[:, worlds.minds.coordinator_of(AVOIDANCE).index])
        if len(running):
            break
    robot, time = running[0], (worlds.ticks[0] - 1) * 0.2
    words = ("explain", evaluated, "--time", time, "--robot")
    assert "inside AvoidCollision: RepulsionFernandez-view2.0" in done(*words, robot)
    (coordinator,) = json.loads(done(*words, robot, "--json"))["coordinators"]
    assert (coordinator["goal"], coordinator["option"]) == ("AvoidCollision", "RepulsionFernandez-view2.0")
    (inside,) = coordinator["inner"]["behaviours"]
    assert (inside["name"], inside["running"], inside["why"]) == ("Avoid", True, "started: ready and active enough")
    idle = next(row for row in range(5) if row not in running)
    assert json.loads(done(*words, idle, "--json"))["coordinators"][0]["inner"] is None


@pytest.mark.parametrize(
    ("name", "expected"),
    [("table1", {"patrols", "goes to an item"}), ("Foraging", {"explores", "goes to food", "goes to the nest"})],
)
def test_a_run_with_a_recording_and_one_without_are_explained_alike(tmp_path, name, expected):
    words = ("evaluate", name, "--strategy", "Random", "--scenarios", 1, "--workers", 1, "--output", tmp_path / "run")
    done(*words, "--minds")
    shutil.copytree(tmp_path / "run", tmp_path / "bare", ignore=shutil.ignore_patterns("recordings"))
    task, path = task_of(tmp_path / "run", None, "Random"), tmp_path / "run" / "recordings" / "test-1-Random.swarm"
    recording, said = RecordedMission(path), set()
    for batch, *_ in steps_of(task):
        worlds, frame = batch.worlds, int(batch.worlds.ticks[0]) - 1
        if frame % 30 == 7:
            told = explain_robot(worlds, frame // 30 % worlds.robots)
            facts = facts_of(worlds, told, recording.at(frame), 0.0)
            said.add(sentence(facts, type(worlds.task)).partition(",")[0].partition(":")[0])
            assert facts.target is None or facts.target[1] < 22.0
    assert said >= expected
    for robot, time in ((0, 3.0), (4, 21.0)):
        which = ("--condition", "Random", "--robot", robot, "--time", time)
        read, again = (command("explain", tmp_path / folder, *which) for folder in ("run", "bare"))
        assert read == again
        assert read[2] == f"run again up to {time:g} s\n"
    which = ("--condition", "Random", "--robot", 4)
    read, again = (command("explain", tmp_path / folder, *which) for folder in ("run", "bare"))
    assert read[:2] == again[:2]
    assert read[2] == f"read from {path}\n"
    missing = f"{tmp_path / 'bare' / 'recordings'} has no recording of it (evaluate --minds makes one)"
    assert again[2] == f"run again: {missing}\n"
