"""However a command ends, it says so in one line, leaves whole files, and keeps what was done before."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from selector.documents.writing import remove_parts, write_whole
from tests.paths import ROOT
from tests.train.records import record
from train.running.finished_runs import Results
from train.running.run_folder import RunFolder

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals and limits of POSIX")
IDENTITY = {"identity": {"experiment": "x"}}


def start(directory, *words, seconds="0.1", most_bytes=None):
    """Start the command line on the fake mission; files grow to `most_bytes`, as on a disk that is full then."""
    command = [sys.executable, "-m", "tests.train.fake_mission", "evaluate", *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "FAKE_SECONDS": seconds}
    limit = None if most_bytes is None else lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes,) * 2)
    pipes = {"stderr": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, cwd=directory, env=environment, start_new_session=True, preexec_fn=limit, **pipes)


def rows(directory):
    return [line.rpartition(",")[0] for line in (directory / "runs.csv").read_text().splitlines()]


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_signals_that_end_programs_end_an_evaluation_like_ctrl_c(tmp_path, name):
    process = start(tmp_path, "--scenarios", "20", "--output", "r", "--workers", "2", seconds="0.3")
    end = time.monotonic() + 120.0
    while not (tmp_path / "r" / "runs.jsonl").exists() or not (tmp_path / "r" / "runs.jsonl").read_text():
        assert time.monotonic() < end
        time.sleep(0.05)
    os.kill(process.pid, getattr(signal, name))
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "interrupted: " in err
    assert "Traceback" not in err
    assert "semaphore" not in err
    assert not list((tmp_path / "r").glob(".*"))


def test_a_full_disk_is_one_line_and_what_was_done_stays(tmp_path):
    words = ("--scenarios", "8", "--output", "r", "--workers", "1")
    process = start(tmp_path, *words, seconds="0", most_bytes=16_000)
    _, err = process.communicate(timeout=120)
    assert process.returncode == 1
    assert "cannot be written (File too large); earlier results stay" in err.replace("\n", " ")
    assert "Traceback" not in err
    assert not list((tmp_path / "r").glob(".*"))
    process = start(tmp_path, *words, "--resume", seconds="0")
    assert process.wait(timeout=120) == 0
    process = start(tmp_path, *words[:2], "--output", "whole", "--workers", "1", seconds="0")
    assert process.wait(timeout=120) == 0
    assert rows(tmp_path / "r") == rows(tmp_path / "whole")


def synced(monkeypatch):
    """Return the list that gets the name of every file that is brought to the disk."""
    found = []
    monkeypatch.setattr(os, "fsync", lambda number: found.append(Path(os.readlink(f"/proc/self/fd/{number}")).name))
    return found


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_what_is_promised_to_be_kept_is_on_the_disk_before_it_counts(tmp_path, monkeypatch):
    results = Results(RunFolder(tmp_path / "r", IDENTITY, resume=False))
    names = synced(monkeypatch)
    results.add(record("2", "a"))
    assert names == ["runs.jsonl"]
    names.clear()
    replaced = []
    monkeypatch.setattr(Path, "replace", lambda path, target: replaced.append((list(names), path, target)))
    write_whole(tmp_path / "whole.txt", b"content")
    [(before, part, target)] = replaced
    assert before == [part.name]
    assert part != target  # else a half-written file would stand in the place of the old one


def test_parts_of_dead_writers_go_and_those_of_living_ones_stay(tmp_path):
    dead = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, text=True)
    parts = {pid: tmp_path / f".runs.jsonl.{pid}.part" for pid in (int(dead.stdout), os.getpid())}
    for part in parts.values():
        part.write_text("half")
    (tmp_path / "notes.part").write_text("mine")
    remove_parts(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"notes.part", parts[os.getpid()].name}


def test_a_directory_that_holds_only_parts_of_the_dead_counts_as_empty(tmp_path):
    (tmp_path / ".manifest.json.999999999.part").write_text("half")
    RunFolder(tmp_path, IDENTITY, resume=False)
    assert [path.name for path in tmp_path.iterdir()] == ["manifest.json"]
    assert json.loads((tmp_path / "manifest.json").read_text())["identity"] == IDENTITY["identity"]
