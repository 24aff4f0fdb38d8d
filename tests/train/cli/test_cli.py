"""The command line as a user meets it: results, errors of one line, Ctrl-C and going on."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from clean_swarm_env import __version__
from selector.documents.find import KINDS, files_of
from tests.paths import ROOT
from tests.train import fake_mission
from tests.train.commands import told
from train.cli.listing import LINES
from train.evaluation import trial_task

FILES = {"manifest.json", "runs.jsonl", "runs.csv", "summary.json", "table.md", "figure.png"}


@pytest.fixture
def run(fake_missions, monkeypatch, capsys, tmp_path):
    """Run the command line in this process, on the fake mission, in an empty directory: code, output, errors."""
    monkeypatch.chdir(tmp_path)
    return partial(told, capsys)


def _rows(directory: Path) -> list[dict[str, str]]:
    with (directory / "runs.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def _but_for_wall(directory: Path) -> list[str]:
    return [line.rpartition(",")[0] for line in (directory / "runs.csv").read_text().splitlines()]


def test_the_default_is_table_1_on_its_five_start_configurations(run, tmp_path):
    code, out, err = run("evaluate", "--workers", 1)
    assert code == 0, err
    directory = tmp_path / "results" / "table1-seed0"
    assert {path.name for path in directory.iterdir()} == FILES
    assert str(directory.relative_to(tmp_path)) in out
    rows = _rows(directory)
    assert [(r["scenario"], r["condition"]) for r in rows] == [
        (str(k), c) for k in range(1, 6) for c in ("RepulsionFernandez", "RepulsionGradient")
    ]
    assert {r["experiment"] for r in rows} == {"table1"}
    assert "846.7" in out
    assert "1484.70" in (directory / "table.md").read_text()
    manifest = json.loads((directory / "manifest.json").read_text())
    assert manifest["identity"]["seed"] == 0
    assert {"python", "numpy", "numba", "pymunk", "clean-swarm"} <= set(manifest["versions"])
    assert len(manifest["identity"]["configuration"]["starts"]) == 5
    assert "knowledge/cleaning.yaml" in manifest["identity"]["files"]


def test_a_second_run_goes_to_a_new_directory(run, tmp_path):
    for _ in range(2):
        assert run("evaluate", "--workers", 1)[0] == 0
    assert {path.name for path in (tmp_path / "results").iterdir()} == {"table1-seed0", "table1-seed0-2"}


def test_equal_seeds_give_equal_runs_with_one_and_two_workers_and_others_do_not(run, tmp_path):
    for name, seed, workers in (("a", 7, 1), ("b", 7, 2), ("c", 8, 1)):
        words = ("--scenarios", 3, "--seed", seed, "--workers", workers, "--output", tmp_path / name)
        assert run("evaluate", *words)[0] == 0
    assert _but_for_wall(tmp_path / "a") == _but_for_wall(tmp_path / "b")
    assert (tmp_path / "a" / "summary.json").read_bytes() == (tmp_path / "b" / "summary.json").read_bytes()
    assert (tmp_path / "a" / "figure.png").read_bytes() == (tmp_path / "b" / "figure.png").read_bytes()
    durations = [{r["duration_s"] for r in _rows(tmp_path / name)} for name in "ac"]
    assert not durations[0] & durations[1]


def test_conditions_share_the_scenarios_and_more_scenarios_keep_the_first(run, tmp_path):
    for count in (2, 4):
        run("evaluate", "--scenarios", count, "--workers", 1, "--output", tmp_path / str(count))
    starts = [
        json.loads((tmp_path / name / "manifest.json").read_text())["identity"]["configuration"]["starts"]
        for name in "24"
    ]
    assert starts[0] == starts[1][:2]
    assert _but_for_wall(tmp_path / "2") == _but_for_wall(tmp_path / "4")[:5]


def test_one_condition_alone(run, tmp_path):
    code, _, err = run("evaluate", "--condition", "RepulsionGradient", "--workers", 1, "--output", tmp_path / "r")
    assert code == 0, err
    assert {r["condition"] for r in _rows(tmp_path / "r")} == {"RepulsionGradient"}
    assert json.loads((tmp_path / "r" / "summary.json").read_text())["comparisons"] == []


def _starts_file(path: Path) -> Path:
    measured = {"duration_s": 300.0, "samples_per_s_at_0.5m": 1.0}
    case = {
        "robots": [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        "items": [[2.0, 2.0]],
        "measured": {"RepulsionFernandez, view 2.0": measured, "RepulsionGradient, view 1.5": measured},
    }
    file = {
        "torus_m": [12, 11],
        "recycling": [1, 1],
        "dump": [11.5, 2],
        "cases": [{"id": k, **case} for k in (5, 30, 9)],
    }
    path.write_text(json.dumps(file))
    return path


def test_a_file_of_starts_is_run_and_compared_with_what_was_measured(run, tmp_path):
    starts = _starts_file(tmp_path / "starts.json")
    words = ("evaluate", "table1-reference", "--starts", starts, "--all", "--workers", 1, "--output", tmp_path / "r")
    code, out, err = run(*words)
    assert code == 0, err
    assert [r["scenario"] for r in _rows(tmp_path / "r")] == ["5"] * 3 + ["9"] * 3 + ["30"] * 3
    assert {r["robots"] for r in _rows(tmp_path / "r")} == {"2"}
    summary = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert {(m["condition"], m["metric"], m["measured"]) for m in summary["reference"]} == {
        (condition, metric, figure)
        for condition in ("RepulsionFernandez", "RepulsionGradient")
        for metric, figure in (("duration_s", 300.0), ("samples_per_s_at_0.5m", 1.0))
    }
    assert {(r["a"], r["b"]) for r in summary["reference_ratios"]} == {("RepulsionFernandez", "RepulsionGradient")}
    for text in (out, (tmp_path / "r" / "table.md").read_text()):
        assert "ours beside measured" in text
    mission = json.loads((tmp_path / "r" / "manifest.json").read_text())["identity"]["configuration"]["mission"]
    assert mission["world"]["width"] == 12.0


def _experiment(path: Path, **changes: object) -> Path:
    content = {"name": "mine", "mission": {"base": "table1"}, "conditions": [{"name": "a"}], "scenarios": 2}
    path.write_text(json.dumps(content | changes))
    return path


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["tabel1"], "unknown experiment 'tabel1' (known: disturbed-crowd, patrol, robustness, scout-options, scouts"),
        (["none.yaml"], "none.yaml: no such file"),
        (
            ["--condition", "Gradient"],
            "table1: unknown condition 'Gradient' (known: RepulsionFernandez, RepulsionGradient",
        ),
        (["--scenarios", "0"], "--scenarios: expected a whole number of at least 1, got 0"),
        (["--workers", "-1"], "--workers: expected"),
        (["--seed", "-1"], "--seed: expected"),
        (["--starts", "none.json"], "none.json: cannot be read (No such file or directory)"),
        (
            ["--starts", "broken.json"],
            "broken.json: line 1: expected JSON, got ",
        ),
        (["--starts", "broken.json", "--scenarios", "3"], "--scenarios and --starts: expected one of them, got both"),
        (["--output", "taken"], "taken: has other files"),
        (["misspelt.yaml"], "misspelt.yaml: mission.world.widht: unknown key 'widht'"),
        (["crowded.yaml"], "crowded.yaml: mission.robots.count: expected at most 277 solid robots"),
        (["scores.yaml"], "unknown option 'Repulsion' (known: RepulsionFernandez"),
        (["goals.yaml"], "unknown goal 'Avoid' (known: AvoidCollision"),
        (["knowledge.yaml"], "unknown expert knowledge 'nothing' (known: avoidance, cleaning"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2_and_writes_nothing(run, tmp_path, words, expected):
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "thesis.txt").write_text("mine")
    (tmp_path / "broken.json").write_text("{")
    _experiment(tmp_path / "misspelt.yaml", mission={"base": "table1", "world": {"widht": 3}})
    _experiment(tmp_path / "crowded.yaml", mission={"base": "table1", "robots": {"count": 1000}})
    _experiment(tmp_path / "scores.yaml", conditions=[{"name": "a", "scores": {"AvoidCollision": {"Repulsion": 1}}}])
    _experiment(tmp_path / "goals.yaml", conditions=[{"name": "a", "scores": {"Avoid": {}}}])
    _experiment(tmp_path / "knowledge.yaml", mission={"base": "table1", "knowledge": "nothing"})
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    code, out, err = run("evaluate", *words)
    assert (code, out) == (2, "")
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert expected in err
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_resuming_does_only_what_is_missing(run, tmp_path, monkeypatch):
    words = ("evaluate", "--scenarios", 4, "--workers", 1, "--output", tmp_path / "r")
    assert run(*words)[0] == 0
    whole = _but_for_wall(tmp_path / "r")
    journal = (tmp_path / "r" / "runs.jsonl").read_text().splitlines(keepends=True)
    (tmp_path / "r" / "runs.jsonl").write_text("".join(journal[:5]))
    monkeypatch.setenv("FAKE_LOG", str(tmp_path / "log"))
    code, _, err = run(*words, "--resume")
    assert code == 0, err
    assert (tmp_path / "log").read_text().split() == ["3", "4", "4"]
    assert _but_for_wall(tmp_path / "r") == whole


@pytest.mark.parametrize("change", [("--seed", 1), ("--scenarios", 3), ("--condition", "RepulsionGradient")])
def test_resuming_something_else_is_refused(run, tmp_path, change):
    words = ("evaluate", "--scenarios", 2, "--workers", 1, "--output", tmp_path / "r")
    assert run(*words)[0] == 0
    code, _, err = run(*words, *change, "--resume")
    assert code == 2
    assert "has other results" in err


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_in_a_run_is_not_hidden_and_keeps_the_finished_runs(run, tmp_path, monkeypatch, workers):
    monkeypatch.setattr(trial_task, "run_mission", fake_mission.run_mission_but_not_2)
    words = ("evaluate", "--scenarios", 3, "--workers", workers, "--output", tmp_path / "r")
    with pytest.raises(ZeroDivisionError, match="scenario 2"):
        run(*words)
    assert {r["scenario"] for r in _rows(tmp_path / "r")} >= ({"1"} if workers == 1 else set())
    monkeypatch.setattr(trial_task, "run_mission", fake_mission.run_mission)
    assert run(*words, "--resume")[0] == 0
    assert len(_rows(tmp_path / "r")) == 6


def test_a_mission_that_kills_three_workers_is_named_and_keeps_the_finished_runs(run, tmp_path, monkeypatch):
    monkeypatch.setattr(trial_task, "run_mission", fake_mission.run_mission_but_die_on_2)
    words = ("evaluate", "--scenarios", 3, "--condition", "RepulsionGradient", "--output", tmp_path / "r")
    code, _, err = run(*words, "--workers", 2)
    assert code == 1
    assert "scenario 2, condition RepulsionGradient: its worker died 3 times: " in err
    monkeypatch.setattr(trial_task, "run_mission", fake_mission.run_mission)
    assert run(*words, "--resume", "--workers", 1)[0] == 0
    assert len(_rows(tmp_path / "r")) == 3


def test_listing_names_everything_of_each_kind(run):
    assert KINDS.keys() < LINES.keys()
    for kind in LINES:
        code, out, _ = run("list", kind)
        assert code == 0
        assert all(name in out for name in (files_of(kind) if kind in KINDS else ()))
    assert "RepulsionFernandez-view1.5" in run("list", "experiments")[1]
    for kind, name in (("strategy-classes", "UCB1"), ("tasks", "CircleFormation"), ("terms", "encounter")):
        assert name in run("list", kind)[1]
    code, out, _ = run("--version")
    assert (code, out) == (0, f"clean-swarm {__version__}\n")


def test_a_shell_completes_commands(run):
    assert "--install-completion" in run("--help")[1]
    typed = {"_CLEAN_SWARM_COMPLETE": "complete_bash", "COMP_WORDS": "clean-swarm tr", "COMP_CWORD": "1"}
    script = "import sys; sys.argv = ['clean-swarm']; from train.cli import main; main()"
    command, environment = [sys.executable, "-c", script], {**os.environ, "PYTHONPATH": str(ROOT), **typed}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["train"]


@pytest.mark.parametrize(("command", "config"), [("ppo", "exploring-ppo"), ("es", "es"), ("design", "design")])
def test_help_names_the_training_that_runs_by_default(run, command, config):
    assert f"[default: {config}]" in run("train", command, "--help")[1]


def _start(tmp_path: Path, *words: str, seconds: str) -> subprocess.Popen[str]:
    """Start the command line in a process group of its own, as a terminal does."""
    command = [sys.executable, "-m", "tests.train.fake_mission", "evaluate", *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "FAKE_SECONDS": seconds}
    pipes = {"stderr": subprocess.PIPE, "stdout": subprocess.PIPE}
    return subprocess.Popen(command, cwd=tmp_path, env=environment, text=True, start_new_session=True, **pipes)


def _wait_for_runs(directory: Path, count: int) -> None:
    journal, end = directory / "runs.jsonl", time.monotonic() + 60.0
    while not journal.exists() or journal.read_text().count("\n") < count:
        assert time.monotonic() < end, "no run finished in a minute"
        time.sleep(0.05)


@pytest.mark.parametrize("workers", ["1", "2"])
def test_ctrl_c_keeps_the_finished_runs_and_says_how_to_go_on(run, tmp_path, workers):
    words = ["--scenarios", "20", "--output", "r", "--workers", workers]
    process = _start(tmp_path, *words, seconds="0.3")
    _wait_for_runs(tmp_path / "r", 3)
    began = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert time.monotonic() - began < 20.0
    assert process.returncode == 130
    kept = _rows(tmp_path / "r")
    assert 3 <= len(kept) < 40
    assert f"{len(kept)} of 40 runs are kept" in err
    assert "Traceback" not in err
    line = next(line for line in err.splitlines() if line.strip().startswith("clean-swarm evaluate"))
    code, _, err = run(*line.split()[1:], "--workers", 1)
    assert code == 0, err
    assert len(_rows(tmp_path / "r")) == 40
    run("evaluate", "--scenarios", 20, "--output", "whole", "--workers", 1)
    assert _but_for_wall(tmp_path / "whole") == _but_for_wall(tmp_path / "r")


def test_ctrl_c_while_the_workers_start_is_quiet(tmp_path):
    process = _start(tmp_path, "--output", "r", "--workers", "2", seconds="0.3")
    end = time.monotonic() + 60.0
    while not (tmp_path / "r" / "runs.jsonl").exists():
        assert time.monotonic() < end
        time.sleep(0.01)
    time.sleep(0.3)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in err


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_worker_that_is_killed_costs_no_finished_run(tmp_path):
    process = _start(tmp_path, "--scenarios", "20", "--output", "r", "--workers", "2", seconds="0.5")
    _wait_for_runs(tmp_path / "r", 2)
    for child in _children(process.pid):
        if "spawn_main" in Path(f"/proc/{child}/cmdline").read_text():
            os.kill(int(child), signal.SIGKILL)
            break
    _, err = process.communicate(timeout=60)
    assert process.returncode == 0, err
    assert len(_rows(tmp_path / "r")) == 40


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_workers_end_with_a_parent_that_is_killed(tmp_path):
    process = _start(tmp_path, "--scenarios", "20", "--output", "r", "--workers", "2", seconds="0.5")
    _wait_for_runs(tmp_path / "r", 1)
    children = _children(process.pid)
    assert len(children) >= 2
    process.kill()
    process.communicate()
    end = time.monotonic() + 20.0
    while running := [child for child in children if Path(f"/proc/{child}").exists() and _state(child) != "Z"]:
        assert time.monotonic() < end, f"{running} still run"
        time.sleep(0.1)


def _children(process: int) -> list[str]:
    return Path(f"/proc/{process}/task/{process}/children").read_text().split()


def _state(process: str) -> str:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return "Z"
