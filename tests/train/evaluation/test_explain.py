"""`clean-swarm explain` and `record`: a run repeated with explained robots takes the same course and tells why."""

import json
from pathlib import Path

import numpy as np
import pytest

from clean_swarm_env.config.starts import run_seed
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.tasks.cleaning.robot import GOAL
from clean_swarm_env.world.mission import Course, MissionResult, MissionRun, run_mission
from tests.clean_swarm_env.courses import difference, snapshot
from tests.train.commands import run
from train.evaluation.repeat import steps_of, task_of

CONDITIONS = [
    {"name": name, "scores": {"AvoidCollision": {name: 2.0}}} for name in ("RepulsionFernandez", "RepulsionGradient")
]


@pytest.fixture(scope="module")
def evaluated(tmp_path_factory) -> Path:
    """Results of four short missions: two of five robots and two items, with either condition."""
    directory = tmp_path_factory.mktemp("results")
    mission = {"base": "table1", "task": {"garbage": {"count": 2}}}
    experiment = {"name": "short", "mission": mission, "conditions": CONDITIONS}
    (directory / "short.yaml").write_text(json.dumps(experiment))
    words = ["evaluate", directory / "short.yaml", "--scenarios", 2, "--seed", 5, "--workers", 1]
    assert run(*words, "--output", directory / "run") == 0
    return directory / "run"


@pytest.fixture(scope="module")
def changing(tmp_path_factory) -> Path:
    """Results of a short mission in which robot 5 joins, robot 1 fails and robot 2 is taken away."""
    directory = tmp_path_factory.mktemp("changing")
    events = [
        {"at": 2.0, "do": "join", "places": [[5.0, 1.0, 0.5]]},
        {"at": 3.0, "do": "fail", "robots": [1]},
        {"at": 4.0, "do": "remove", "robots": [2]},
    ]
    mission = {"base": "table1", "events": events, "time_limit": 8.0}
    (directory / "short.yaml").write_text(
        json.dumps({"name": "short", "mission": mission, "conditions": CONDITIONS[:1]})
    )
    words = ["evaluate", directory / "short.yaml", "--scenarios", 1, "--workers", 1]
    assert run(*words, "--output", directory / "run") == 0
    return directory / "run"


@pytest.fixture
def told(capsys, monkeypatch):
    """Run the command line: code, output, errors."""
    monkeypatch.setenv("COLUMNS", "80")

    def call(*words: object) -> tuple[int, str, str]:
        capsys.readouterr()
        code = run(*words)
        return code, *capsys.readouterr()

    return call


def test_an_explained_run_takes_the_same_course_bit_for_bit(evaluated):
    for condition in ("RepulsionFernandez", "RepulsionGradient"):
        task = task_of(evaluated, "2", condition)
        plain = Course(MissionRun(task.first.mission, task.first.start, run_seed(5, "2"), task.scores))
        for explained in steps_of(task):
            assert plain.in_progress
            plain.tick()
            assert difference([snapshot(plain.worlds, 0)], [snapshot(explained, 0)]) == ""
        assert not plain.in_progress


def test_a_repeated_run_comes_to_what_the_evaluation_wrote(evaluated):
    for line in (evaluated / "runs.jsonl").read_text().splitlines():
        held = json.loads(line)
        task = task_of(evaluated, held["scenario"], held["condition"])
        again = run_mission(task.first.mission, task.first.start, run_seed(task.seed, task.first.id), task.scores)
        fields = set(MissionResult.__dataclass_fields__) - {"measures"}  # which only other tasks have
        assert json.loads(json.dumps({name: getattr(again, name) for name in fields})) == {
            name: held[name] for name in fields
        }


@pytest.mark.parametrize("time", [0.0, 0.2, 7.0, 30.0])
def test_how_long_a_robot_has_stayed_and_done_what_it_does_is_told(evaluated, told, time):
    task, step = task_of(evaluated), round(time / 0.2)
    course = Course(MissionRun(task.first.mission, task.first.start, run_seed(5, "1"), task.scores))
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
        code, out, err = told("explain", evaluated, "--robot", robot, "--time", time, "--json")
        assert code == 0, err
        shown = json.loads(out)
        assert shown["stayed_s"] == pytest.approx((step - since) * 0.2)
        assert shown["running_s"].keys() == {name for b, name in enumerate(names) if runs[step][robot, b]}
        for name, seconds in shown["running_s"].items():
            began = max([-1, *(k for k in range(step + 1) if not runs[k][robot, names.index(name)])]) + 1
            assert seconds == pytest.approx((step - began + 1) * 0.2)


def test_robots_that_join_are_explained_from_then_on(changing, told):
    code, out, err = told("explain", changing, "--robot", 5, "--time", 1.8)
    assert (code, out) == (2, "")
    assert err == (
        "error: robot 5: expected a robot that is in the team at 1.8 s; "
        "it joins at 2 s, or later if its place is not free\n"
    )
    code, out, err = told("explain", changing, "--robot", 6, "--time", 1.0)
    assert (code, err) == (2, "error: --robot: expected a number from 0 to 5, got 6\n")
    path = changing.parent / "run.swarm"
    assert told("record", changing, "--output", path)[0] == 0
    places = np.stack([RecordedMission(path)["x"][:, 5], RecordedMission(path)["y"][:, 5]], axis=1)
    for frame in (10, 11, 20, 39):
        code, out, err = told("explain", changing, "--robot", 5, "--time", frame * 0.2, "--json")
        assert code == 0, err
        step = json.loads(out)
        near = np.linalg.norm(places[10:frame] - places[frame], axis=1) < 0.1
        since = max([-1, *np.flatnonzero(~near)]) + 1
        assert (step["robot"], step["state"]) == (5, "at work")
        assert step["stayed_s"] == pytest.approx((frame - 10 - since) * 0.2)
        assert all(0.2 <= seconds <= (frame - 9) * 0.2 + 1e-9 for seconds in step["running_s"].values())


def test_robots_that_are_not_at_work_are_said_to_be(changing, told):
    for robot, time, state, said in (
        (1, 2.8, "at work", ""),
        (1, 3.0, "failed", "it has failed: its body stays"),
        (2, 3.8, "at work", ""),
        (2, 4.0, "taken away", "it has been taken away"),
    ):
        words = ("explain", changing, "--robot", robot, "--time", time)
        assert json.loads(told(*words, "--json")[1])["state"] == state
        lines = told(*words)[1].splitlines()
        assert not said or said in lines
        assert not said or not any("has run for" in line or "has stayed" in line for line in lines)


def test_a_step_is_a_table_and_a_tree_of_80_columns(evaluated, told):
    code, out, err = told("explain", evaluated, "--robot", 3, "--time", 4.1)
    assert code == 0, err
    lines = out.splitlines()
    assert max(map(len, lines)) <= 80
    assert lines[0] == "short, seed 5, RepulsionFernandez, scenario 1"
    assert lines[1].startswith("robot 3 at 4 s (step 20); AvoidCollision by RepulsionFernandez")
    assert any("has run for" in line for line in lines)
    assert any(line.startswith("plan: [") for line in lines)
    assert any(" of " in line and line.endswith("is due") for line in lines)
    (head,) = (line.split() for line in lines if line.split()[:2] == ["behaviour", "active"])
    assert len(head) == 9
    for name in ("Patrol", "MoveToGarbage", "PickGarbage", "MoveToRecycling", "Recycle", "MoveToDump", "Dump"):
        assert sum(line.lstrip("│├└─ *").startswith(f"{name}:") for line in lines) == 1
    assert any(line.startswith("goal ") for line in lines)


def test_json_holds_the_same_step_of_every_robot(evaluated, told):
    worlds = next(w for w in steps_of(task_of(evaluated, "2", "RepulsionGradient")) if w.ticks[0] == 51)
    names = [behaviour.name for behaviour in worlds.network.model.behaviours]
    for robot in range(5):
        words = ("--scenario", 2, "--condition", "RepulsionGradient", "--json")
        code, out, _ = told("explain", evaluated, "--robot", robot, "--time", 10, *words)
        assert code == 0
        step = json.loads(out)
        assert (step["scenario"], step["condition"], step["robot"]) == ("2", "RepulsionGradient", robot)
        assert (step["step"], step["time_s"]) == (50, 10.0)
        assert step["options"] == {"AvoidCollision": "RepulsionGradient"}
        running = {account["name"] for account in step["behaviours"] if account["running"]}
        assert running == {name for b, name in enumerate(names) if worlds.network.executing[robot, b]}
        assert list(step["readings"].values()) == worlds.network.readings[robot].tolist()
        assert set(step["plan"]) <= set(names)
        assert 0 <= step["plan_index"] <= len(step["plan"])


def test_the_plan_from_finding_to_dumping_is_seen(evaluated):
    """Robots that see garbage plan to find, pick, recycle and dump it."""
    task = task_of(evaluated)
    wanted = ["PickGarbage", "MoveToRecycling", "Recycle", "MoveToDump", "Dump"]
    for worlds in steps_of(task):
        names = [behaviour.name for behaviour in worlds.network.model.behaviours]
        for robot in range(5):
            plan = [names[b] for b in worlds.network.state.plan[robot, : worlds.network.state.plan_marks[robot, 1]]]
            if [name for name in plan if name in wanted] == wanted:
                return
    pytest.fail(f"no robot ever planned {wanted}")


def test_the_last_step_is_the_one_that_dumps_the_last_item(evaluated, told):
    first = json.loads((evaluated / "runs.jsonl").read_text().splitlines()[0])
    end = first["duration_s"]
    words = ("--robot", 0, "--scenario", first["scenario"], "--condition", first["condition"])
    assert told("explain", evaluated, *words, "--time", end)[0] == 0
    code, _, err = told("explain", evaluated, *words, "--time", end + 0.2)
    assert code == 2
    assert f"this mission was completed after {end:g} s" in err


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--scenario", "7"], "run: unknown scenario '7' (known: 1, 2; 2 in all)"),
        (["--condition", "RepulsionGradiant"], "unknown condition 'RepulsionGradiant' (known: RepulsionFernandez, "),
        (["--robot", "5"], "--robot: expected a number from 0 to 4, got 5"),
        (["--robot", "-1"], "--robot: expected a number from 0 to 4, got -1"),
        (["--time", "-1"], "--time: expected seconds from 0 on, got -1"),
        (["--time", "nan"], "--time: expected seconds from 0 on, got nan"),
        (["--time", "1e9"], "--time 1e+09: this mission was completed after "),
    ],
)
def test_what_does_not_exist_is_one_line(evaluated, told, words, expected):
    code, out, err = told("explain", evaluated, "--robot", 0, "--time", 1.0, *words)
    assert code == 2
    assert out == ""
    assert expected in err
    assert err.startswith("error: ")
    assert len(err.splitlines()) == 1


def test_directories_without_results_are_refused(tmp_path, told):
    words = ("--robot", 0, "--time", 1)
    code, _, err = told("explain", tmp_path / "none", *words)
    missing = f"error: {tmp_path / 'none'}: cannot be read (No such file or directory)"
    assert (code, err.splitlines()) == (2, [missing])
    code, _, err = told("explain", tmp_path, *words)
    assert code == 2
    assert "has no manifest.json; expected the results of an evaluation" in err
    (tmp_path / "run.swarm").write_bytes(b"")
    code, _, err = told("explain", tmp_path / "run.swarm", *words)
    assert (code, err) == (2, f"error: {tmp_path / 'run.swarm'}: expected a directory of results, got a file\n")
    cases = {
        "{": "manifest.json: line 1: ",
        "[]": "manifest.json: expected a mapping of keys, got list",
        "{}": "expected the manifest of an evaluation",
        '{"identity": {"learner": "ppo"}}': "expected the results of an evaluation, got those of a training",
        '{"identity": {"study": {}, "family": {}}}': "expected the results of an evaluation, got those of a study",
    }
    for content, expected in cases.items():
        (tmp_path / "manifest.json").write_text(content)
        code, _, err = told("explain", tmp_path, *words)
        assert code == 2
        assert expected in err
        assert len(err.splitlines()) == 1


def _with_manifest(evaluated, directory, change) -> Path:
    manifest = json.loads((evaluated / "manifest.json").read_text())
    change(manifest)
    (directory / "manifest.json").write_text(json.dumps(manifest))
    return directory


def test_a_run_of_other_mechanisms_is_not_repeated(evaluated, tmp_path, told):
    def change(manifest):
        manifest["identity"]["files"]["mechanisms/RepulsionGradient.yaml"] = "0"

    code, _, err = told("explain", _with_manifest(evaluated, tmp_path, change), "--robot", 0, "--time", 1)
    assert code == 2
    assert "mechanisms/RepulsionGradient.yaml has changed since the evaluation" in err


def test_a_manifest_with_a_mistake_names_file_and_key(evaluated, tmp_path, told):
    def change(manifest):
        manifest["identity"]["configuration"]["mission"]["robots"]["radius"] = -1.0

    code, _, err = told("explain", _with_manifest(evaluated, tmp_path, change), "--robot", 0, "--time", 1)
    assert code == 2
    assert "manifest.json: identity.configuration: mission.robots.radius: expected" in err


def test_other_versions_are_noted(evaluated, tmp_path, told):
    def change(manifest):
        manifest["versions"]["numba"] = "0.1"

    code, _, err = told("explain", _with_manifest(evaluated, tmp_path, change), "--robot", 0, "--time", 1)
    assert code == 0
    assert "the course may differ from the one then: numba 0.1, now " in err


def test_a_mission_that_ran_out_of_time_says_so(evaluated, tmp_path, told):
    def change(manifest):
        manifest["identity"]["configuration"]["mission"]["time_limit"] = 3.0

    directory = _with_manifest(evaluated, tmp_path, change)
    assert told("explain", directory, "--robot", 0, "--time", 2.9)[0] == 0
    code, _, err = told("explain", directory, "--robot", 0, "--time", 3.0)
    assert code == 2
    assert "this mission ended uncompleted at its time limit of 3 s" in err


def test_a_recording_holds_what_explain_says(evaluated, tmp_path, told):
    path = tmp_path / "run.swarm"
    code, out, err = told("record", evaluated, "--output", path, "--scenario", "2")
    assert code == 0, err
    recording = RecordedMission(path)
    assert recording.head["about"] == {
        "scenario": "2",
        "seed": run_seed(5, "2"),
        "experiment": "short",
        "condition": "RepulsionFernandez",
    }
    assert out == f"{recording.frames} steps of 5 robots in {path}\n"
    held = next(r for r in map(json.loads, (evaluated / "runs.jsonl").open()) if r["scenario"] == "2")
    assert recording.result == {name: held[name] for name in MissionResult.__dataclass_fields__ if name != "measures"}
    assert recording.frames == held["ticks"]
    names = recording.head["networks"]["robot"]
    for frame, robot in ((0, 0), (40, 1), (recording.frames - 1, 4)):
        time = frame * recording.period
        step = json.loads(told("explain", evaluated, "--scenario", 2, "--robot", robot, "--time", time, "--json")[1])
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
    code, _, err = told("record", evaluated, "--output", path)
    assert (code, "exists already; expected a new file" in err) == (2, True)
    code, _, err = told("record", evaluated, "--output", tmp_path / "run.npz")
    assert (code, "expected a name that ends with .swarm" in err) == (2, True)


def test_a_running_coordinator_is_explained_from_inside(evaluated, told):
    for worlds in steps_of(task_of(evaluated)):
        running = np.flatnonzero(worlds.network.executing[:, worlds.minds.coordinator_of(GOAL).index])
        if len(running):
            break
    robot, time = running[0], (worlds.ticks[0] - 1) * 0.2
    _, out, _ = told("explain", evaluated, "--robot", robot, "--time", time)
    assert "inside AvoidCollision: RepulsionFernandez" in out
    _, out, _ = told("explain", evaluated, "--robot", robot, "--time", time, "--json")
    (coordinator,) = json.loads(out)["coordinators"]
    assert (coordinator["goal"], coordinator["option"]) == ("AvoidCollision", "RepulsionFernandez")
    (inside,) = coordinator["inner"]["behaviours"]
    assert (inside["name"], inside["running"], inside["why"]) == ("Avoid", True, "started: ready and active enough")
    idle = next(row for row in range(5) if row not in running)
    _, out, _ = told("explain", evaluated, "--robot", idle, "--time", time, "--json")
    assert json.loads(out)["coordinators"][0]["inner"] is None


def test_a_recording_needs_a_directory(evaluated, tmp_path, told):
    code, _, err = told("record", evaluated, "--output", tmp_path / "none" / "run.swarm")
    assert code == 2
    assert "cannot be written" in err
