"""Faults from outside: kills at random moments, two commands on one directory, a clock that jumps."""

import os
import random
import signal
import subprocess
import sys
import time

import pytest

from selector.documents.errors import DocumentError
from tests.paths import ROOT
from tests.train.cli.test_endings import rows, start
from train.running.run_folder import RunFolder

fcntl = pytest.importorskip("fcntl", reason="signals and locks of POSIX")
WORDS = ("--scenarios", "6", "--output", "r", "--workers", "2")


def wait_for_runs(process, directory, count):
    """Wait until that number of runs is kept."""
    end = time.monotonic() + 600.0
    while not (directory / "runs.jsonl").exists() or (directory / "runs.jsonl").read_text().count("\n") < count:
        assert process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.01)


def test_kills_at_random_moments_after_the_first_run_cost_no_kept_run(tmp_path):
    draws = random.Random(17)
    process = start(tmp_path, *WORDS, seconds="0.3")
    kept = 0
    for kill in range(3):
        wait_for_runs(process, tmp_path / "r", kept + 1)
        time.sleep(draws.uniform(0.0, 0.4))
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        now = (tmp_path / "r" / "runs.jsonl").read_text().count("\n")
        assert now > kept, kill
        kept = now
        process = start(tmp_path, *WORDS, "--resume", seconds="0.3")
    _, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    whole = start(tmp_path, *WORDS[:2], "--output", "whole", "--workers", "1", seconds="0")
    assert whole.wait(timeout=600) == 0
    assert rows(tmp_path / "r") == rows(tmp_path / "whole")


def test_a_second_command_on_the_same_directory_is_refused_in_one_line(tmp_path):
    assert start(tmp_path, *WORDS, seconds="0").wait(timeout=600) == 0
    before = (tmp_path / "r" / "runs.jsonl").read_bytes()
    number = os.open(tmp_path / "r", os.O_RDONLY)
    fcntl.flock(number, fcntl.LOCK_EX)  # as a command does that writes there
    second = start(tmp_path, *WORDS, "--resume", seconds="0")
    _, err = second.communicate(timeout=600)
    os.close(number)
    assert second.returncode == 2
    assert "r: another command writes these results now" in err.replace("\n", " ")
    assert "Traceback" not in err
    assert (tmp_path / "r" / "runs.jsonl").read_bytes() == before
    assert start(tmp_path, *WORDS, "--resume", seconds="0").wait(timeout=600) == 0


def test_a_directory_is_free_again_when_its_command_ends_or_is_killed(tmp_path):
    folder = RunFolder(tmp_path, {"identity": {}}, resume=False)
    hold = "import fcntl, os, sys, time; n = os.open(sys.argv[1], os.O_RDONLY); fcntl.flock(n, fcntl.LOCK_EX); "
    holder = subprocess.Popen(
        [sys.executable, "-c", hold + "print(1, flush=True); time.sleep(60)", tmp_path], stdout=subprocess.PIPE
    )
    assert holder.stdout.readline() == b"1\n"
    with pytest.raises(DocumentError, match="another command writes these results now"), folder.alone():
        pass
    holder.kill()
    holder.communicate()
    for _ in range(2):
        with folder.alone():
            pass


def test_a_clock_that_jumps_changes_neither_rows_nor_times(tmp_path):
    jumping = "import time, itertools; c = itertools.cycle((4e9, 0.0, 1.7e9)); time.time = lambda: next(c); "
    command = jumping + (
        "from tests.train import fake_mission; from train.evaluation import trial_task; from train.cli import main; "
        "trial_task.run_mission = fake_mission.run_mission; main()"
    )
    words = ("evaluate", "--scenarios", "3", "--workers", "1", "--output")
    environment = {**os.environ, "FAKE_SECONDS": "0", "PYTHONPATH": str(ROOT)}
    for name, code in (("jumping", command), ("steady", command.removeprefix(jumping))):
        done = subprocess.run([sys.executable, "-c", code, *words, name], cwd=tmp_path, env=environment)
        assert done.returncode == 0
    assert rows(tmp_path / "jumping") == rows(tmp_path / "steady")
    walls = [float(line.rpartition(",")[2]) for line in (tmp_path / "jumping" / "runs.csv").read_text().split()[1:]]
    assert all(0.0 <= wall < 60.0 for wall in walls)
