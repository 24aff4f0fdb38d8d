"""Faults from outside: kills at random moments, two commands on one directory, a clock that jumps."""

import itertools
import os
import random
import signal
import subprocess
import sys
import time

import pytest

from selector.documents.errors import DocumentError
from tests.train.commands import done, refused, rows, start, wait_for_runs
from train.running.run_folder import RunFolder

fcntl = pytest.importorskip("fcntl", reason="signals and locks of POSIX")
pytestmark = pytest.mark.usefixtures("undrawn")
WORDS = ("--scenarios", "6", "--output", "r", "--workers", "2")
THREE = ("evaluate", "--scenarios", 3, "--workers", 1, "--output")


@pytest.mark.long
def test_kills_at_random_moments_after_the_first_run_cost_no_kept_run(fake_missions, tmp_path):
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
    done("evaluate", *WORDS[:2], "--output", tmp_path / "whole", "--workers", 1)
    assert rows(tmp_path / "r") == rows(tmp_path / "whole")


def test_a_second_command_on_the_same_directory_is_refused_in_one_line(fake_missions, tmp_path):
    done(*THREE, tmp_path)
    before = (tmp_path / "runs.jsonl").read_bytes()
    number = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(number, fcntl.LOCK_EX)  # as a command does that writes there
    assert "another command writes these results now" in refused(*THREE, tmp_path, "--resume")
    os.close(number)
    assert (tmp_path / "runs.jsonl").read_bytes() == before
    done(*THREE, tmp_path, "--resume")


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


def test_a_clock_that_jumps_changes_neither_rows_nor_times(fake_missions, tmp_path, monkeypatch):
    done(*THREE, tmp_path / "steady")
    monkeypatch.setattr(time, "time", itertools.cycle((4e9, 0.0, 1.7e9)).__next__)
    done(*THREE, tmp_path / "jumping")
    monkeypatch.undo()
    assert rows(tmp_path / "jumping") == rows(tmp_path / "steady")
    walls = (line.rpartition(",")[2] for line in (tmp_path / "jumping" / "runs.csv").read_text().split()[1:])
    assert all(0.0 <= float(wall) < 60.0 for wall in walls)
