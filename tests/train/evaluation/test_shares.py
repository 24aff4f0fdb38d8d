"""Shares of an evaluation: gathered, they are one run; one that is killed, missing or foreign is named in one line."""

import fcntl
import json
import os
import re
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
import yaml

from selector.documents.find import SHIPPED
from tests.paths import ROOT
from tests.train.commands import told
from tests.train.evaluation.test_family_evaluation import FAMILY
from train.evaluation import pipeline

EXPERIMENT = ("evaluate", "--scenarios", 7, "--workers", 1)


@pytest.fixture
def run(fake_missions, monkeypatch, capsys, tmp_path):
    """Run the command line in this process, on the fake mission: code, output, errors."""
    monkeypatch.chdir(tmp_path)
    return partial(told, capsys)


def results(directory: Path) -> tuple[list[str], bytes, bytes]:
    rows = [line.rpartition(",")[0] for line in (directory / "runs.csv").read_text().splitlines()]
    return rows, (directory / "summary.json").read_bytes(), (directory / "table.md").read_bytes()


@pytest.mark.parametrize("count", [1, 3, 20])
def test_gathered_shares_are_one_run(run, tmp_path, count):
    assert run(*EXPERIMENT, "--output", "whole")[0] == 0
    for number in range(count, 0, -1):
        code, out, err = run(*EXPERIMENT, "--output", "shares", "--share", f"{number}/{count}")
        assert code == 0, err
        assert "clean-swarm gather shares" in out
    for _ in range(2):  # gathering twice changes nothing
        code, out, err = run("gather", "shares", "--all")
        assert code == 0, err
        assert "ratios of means" in out
        assert results(tmp_path / "shares") == results(tmp_path / "whole")


def test_each_share_has_some_runs_of_every_condition(run, tmp_path):
    for number in (1, 2):
        run(*EXPERIMENT, "--output", "shares", "--share", f"{number}/2")
        rows = (tmp_path / "shares" / "shares" / f"{number}-of-2" / "runs.csv").read_text().splitlines()[1:]
        assert len(rows) == 7
        assert {row.split(",")[3] for row in rows} == {"RepulsionFernandez", "RepulsionGradient"}


def test_a_killed_share_goes_on_and_is_gathered(run, tmp_path):
    words = ["evaluate", "--scenarios", "7", "--workers", "1", "--output", "shares", "--share", "2/2"]
    command = [sys.executable, "-m", "tests.train.fake_mission", *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "FAKE_SECONDS": "0.3"}
    journal, end = tmp_path / "shares" / "shares" / "2-of-2" / "runs.jsonl", time.monotonic() + 60.0
    with subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while not journal.exists() or journal.read_text().count("\n") < 2:
            assert time.monotonic() < end, "no run finished"
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
    run(*EXPERIMENT, "--output", "shares", "--share", "1/2")
    code, _, err = run("gather", "shares")
    assert (code, err.count("\n")) == (2, 1)
    assert "shares/shares/2-of-2: lacks" in err
    goes_on = err.split("`")[1].split()
    assert goes_on[0] == "clean-swarm"
    assert not (tmp_path / "shares" / "manifest.json").exists()
    assert run(*goes_on[1:], "--workers", 1)[0] == 0
    assert run("gather", "shares")[0] == 0
    run(*EXPERIMENT, "--output", "whole")
    assert results(tmp_path / "shares") == results(tmp_path / "whole")


def test_what_cannot_be_gathered_is_one_line(run, tmp_path):
    share = ("--output", "shares", "--share")
    for number in (1, 3):
        assert run(*EXPERIMENT, *share, f"{number}/3")[0] == 0

    def refused(expected: str) -> None:
        code, _, err = run("gather", "shares")
        assert (code, err.count("\n")) == (2, 1)
        assert expected in err

    refused("shares/shares/2-of-3: no such share; expected the results of `clean-swarm evaluate --scenarios 7")
    run(*EXPERIMENT, "--seed", 1, *share, "2/3")
    refused("shares/shares/2-of-3: has other results: configuration.starts differ")
    folder = tmp_path / "shares" / "shares"
    for path in (folder / "2-of-3").iterdir():
        path.unlink()
    run(*EXPERIMENT, *share, "2/3")
    number = os.open(folder / "2-of-3", os.O_RDONLY)
    fcntl.flock(number, fcntl.LOCK_EX)  # as a share does that still runs
    refused("another command writes these results now")
    os.close(number)
    run(*EXPERIMENT, *share, "1/4")
    refused("expected shares of one number, got shares of 3 and of 4")
    assert not (tmp_path / "shares" / "runs.csv").exists()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("evaluate", "--share", "1/2"), "--share: expected --output"),
        (("evaluate", "--output", "r", "--share", "3/2"), "--share: expected I/N with I from 1 to N, got '3/2'"),
        (("evaluate", "--output", "r", "--share", "0/2"), "--share: expected I/N"),
        (
            ("evaluate", "--output", "r", "--share", "1/2", "--store", "s", "--learn", "--workers", 1),
            "--share: expected no --learn",
        ),
        (("study", "score", "crowded", "--store", "s", "--share", "1/2"), "--share: expected --output"),
        (
            ("evaluate", "--store", "s", "--learn", "--workers", 1, "--on", "tcp://127.0.0.1:1"),
            "--on: expected no --learn, where missions learn in turn",
        ),
        (("gather", "."), "shares: expected shares of one number, got none"),
        (
            ("machine", "slurm", "train", "ppo", "--output", "r"),
            "machine slurm: expected evaluate or study score or study look-ahead or study periods, got train ppo",
        ),
        (("machine", "slurm", "evaluate", "crowded"), "machine slurm: expected a command with --output"),
    ],
)
def test_bad_input_is_one_line(run, words, expected):
    code, _, err = run(*words)
    assert (code, err.count("\n")) == (2, 1)
    assert expected in err


def test_shares_of_scores_reach_the_store_once_when_they_are_gathered(run, tmp_path):
    words = ("study", "score", "table1", "--store", "s.sqlite", "--scenarios", 2, "--workers", 1)
    for number in (1, 2):
        assert run(*words, "--output", "shares", "--share", f"{number}/2")[0] == 0
    assert "learned" not in run("learn", "knowledge", "show", "--store", "s.sqlite")[1]
    code, out, err = run("gather", "shares")
    assert (code, "known now" in out) == (0, False)
    assert "the scores reach no store" in err
    for _ in range(2):
        code, out, err = run("gather", "shares", "--store", "s.sqlite")
        assert code == 0, err
        assert "known now" in out
    assert run(*words, "--output", "whole", "--store", "t.sqlite")[0] == 0
    listed = [
        run("learn", "knowledge", "show", "--store", name)[1].splitlines()[1:] for name in ("s.sqlite", "t.sqlite")
    ]
    gathered, whole = ([re.sub(r"\d\d:\d\d:\d\d", "", line) for line in lines] for lines in listed)
    assert gathered == whole
    assert results(tmp_path / "shares") == results(tmp_path / "whole")


def test_shares_that_begin_with_what_a_store_knows_are_one_run(run, tmp_path):
    table1 = SHIPPED / "experiments" / "table1.yaml"
    assert run("study", "score", table1, "--store", "s.sqlite", "--scenarios", 1, "--workers", 1)[0] == 0
    given = (*EXPERIMENT, "--store", "s.sqlite", "--output")
    for number in (1, 2):
        assert run(*given, "shares", "--share", f"{number}/2")[0] == 0
    assert run(*given, "whole")[0] == 0
    (tmp_path / "s.sqlite").unlink()
    code, out, err = run("gather", "shares", "--all")
    assert code == 0, err
    assert "known at the beginning" in out
    assert results(tmp_path / "shares") == results(tmp_path / "whole")


def test_shares_that_differ_about_a_run_are_an_error_that_names_both(run, tmp_path):
    for number in (1, 2):
        run(*EXPERIMENT, "--output", "shares", "--share", f"{number}/2")
    first, second = (tmp_path / "shares" / "shares" / f"{number}-of-2" / "runs.jsonl" for number in (1, 2))
    line = json.loads(first.read_text().splitlines()[0])
    kept = second.read_text()
    second.write_text(kept + json.dumps(line | {"wall_s": 9.0}) + "\n")
    assert run("gather", "shares")[0] == 0
    second.write_text(kept + json.dumps(line | {"duration_s": 1.0}) + "\n")
    code, _, err = run("gather", "shares")
    assert (code, err.count("\n")) == (2, 1)
    assert "shares/shares/1-of-2 and shares/shares/2-of-2: expected the same figures of scenario " in err


def test_gathering_obeys_no_words_of_a_manifest(run, tmp_path):
    assert run(*EXPERIMENT, "--output", "shares", "--share", "1/1")[0] == 0
    path = tmp_path / "shares" / "shares" / "1-of-1" / "manifest.json"
    content = json.loads(path.read_text())
    words = ["clean-swarm", "evaluate", "--store", "no/such.sqlite", "--configs", "no/such", "--learn"]
    path.write_text(json.dumps(content | {"command": words}))
    assert run("gather", "shares")[0] == 0
    path.write_text(json.dumps(content | {"asked": {"scenarios": 10**9}}))
    code, _, err = run("gather", "shares")
    assert (code, err.count("\n")) == (2, 1)
    assert "1-of-1/manifest.json: asked: scenarios: " in err


def test_the_job_array_of_a_family_gives_what_two_workers_give(tmp_path):
    (tmp_path / "small.yaml").write_text(yaml.safe_dump(FAMILY))
    words = [
        "evaluate",
        "--family",
        "small.yaml",
        "--strategy",
        "fixed:RepulsionGradient",
        "--scenarios",
        "7",
        "--record",
    ]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}

    def do(*command: str, **more: str) -> str:
        given = {"cwd": tmp_path, "env": {**environment, **more}, "capture_output": True, "text": True}
        done = subprocess.run(command, check=False, **given)
        assert done.returncode == 0, done.stderr
        return done.stdout

    program = (sys.executable, "-m", "clean_swarm_env")
    text = do(*program, "machine", "slurm", "--shares", "3", "--sbatch=--time=5", *words, "--output", "array")
    assert text.startswith("#!/bin/sh\n#SBATCH --job-name=clean-swarm\n#SBATCH --array=1-3\n")
    assert "\n#SBATCH --time=5\n" in text
    (tmp_path / "array.sh").write_text(text)
    for number in ("1", "2", "3"):
        do("sh", "array.sh", SLURM_ARRAY_TASK_ID=number, SLURM_CPUS_PER_TASK="2")
    do(*program, "gather", "array")
    do(*program, *words, "--workers", "2", "--output", "whole")
    assert results(tmp_path / "array") == results(tmp_path / "whole")
    array, whole = ({path.name for path in (tmp_path / name).rglob("*.swarm")} for name in ("array", "whole"))
    assert array == whole
    assert len(whole) >= 7


def test_a_share_on_a_machine_whose_missions_end_differently_is_refused_or_noted(run, tmp_path, monkeypatch):
    share = (*EXPERIMENT, "--output", "shares", "--share")
    assert run(*share, "1/2")[0] == 0
    monkeypatch.setattr(pipeline, "own_bits", lambda: {"0123": "an odd CPU"})
    code, _, err = run(*share, "2/2")
    assert (code, err.count("\n")) == (2, 1)
    assert "an odd CPU: missions end differently than on" in err
    assert not (tmp_path / "shares" / "shares" / "2-of-2").exists()
    assert run(*share, "2/2", "--any-bits")[0] == 0
    assert "an odd CPU: missions end differently" in run("gather", "shares")[2]
    assert run("gather", "shares", "--any-bits")[0] == 0
    noted = json.loads((tmp_path / "shares" / "manifest.json").read_text())["workers"]
    assert len(noted) == 2
    assert noted["0123"] == "an odd CPU"
