"""However a command ends, it says so in one line, leaves whole files, and keeps what was done before."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from selector.documents.writing import remove_parts, write_whole
from tests.paths import ROOT
from tests.train.commands import command, done, living, rows, runs, start, wait_for_end, wait_for_runs
from tests.train.records import record
from train.evaluation import pipeline
from train.running.finished_runs import Results
from train.running.run_folder import RunFolder

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="signals and limits of POSIX"),
    pytest.mark.usefixtures("undrawn"),
]
on_linux = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
IDENTITY = {"identity": {"experiment": "x"}}
TWENTY = ("--scenarios", "20", "--output", "r", "--workers")


@pytest.mark.parametrize("workers", ["1", pytest.param("2", marks=pytest.mark.long)])
def test_ctrl_c_keeps_the_finished_runs_and_says_how_to_go_on(fake_missions, tmp_path, monkeypatch, workers):
    monkeypatch.chdir(tmp_path)
    process = start(tmp_path, *TWENTY, workers, seconds="0.3")
    wait_for_runs(process, tmp_path / "r", 3)
    began = time.monotonic()
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=120)
    assert time.monotonic() - began < 60.0
    assert process.returncode == 130
    kept = runs(tmp_path / "r")
    assert 3 <= len(kept) < 40
    assert f"{len(kept)} of 40 runs are kept" in err
    assert "Traceback" not in err
    line = next(line for line in err.splitlines() if line.strip().startswith("clean-swarm evaluate"))
    done(*line.split()[1:], "--workers", 1)
    assert len(runs(tmp_path / "r")) == 40
    done("evaluate", *TWENTY[:2], "--output", "whole", "--workers", 1)
    assert rows(tmp_path / "whole") == rows(tmp_path / "r")


def test_a_signal_before_the_tables_says_how_to_go_on(fake_missions, tmp_path, monkeypatch):
    def end(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(pipeline, "publish", end)
    code, _, err = command("evaluate", "--scenarios", "2", "--output", tmp_path / "r", "--workers", "1")
    assert code == 130
    assert "4 of 4 runs are kept; to go on:\n  clean-swarm evaluate" in err


@pytest.mark.long
@pytest.mark.parametrize(("name", "count"), [("SIGTERM", 1), ("SIGHUP", 1), ("SIGINT", 0)])
def test_signals_that_end_programs_end_an_evaluation_with_workers(tmp_path, name, count):
    """While the workers start, too: SIGINT, with no run that is kept."""
    process = start(tmp_path, *TWENTY, "2", seconds="0.3")
    wait_for_runs(process, tmp_path / "r", count)
    os.kill(process.pid, getattr(signal, name))
    _, err = process.communicate(timeout=120)
    assert process.returncode == 130
    assert ("interrupted: " if count else "interrupted") in err
    assert "Traceback" not in err
    assert "semaphore" not in err
    assert not list((tmp_path / "r").glob(".*"))


@on_linux
@pytest.mark.long
def test_workers_end_with_a_parent_that_is_killed(tmp_path):
    process = start(tmp_path, *TWENTY, "2", seconds="0.5")
    wait_for_runs(process, tmp_path / "r", 1)
    assert len(living(process.pid)) >= 3
    process.kill()
    process.communicate()
    wait_for_end(process.pid)


def test_a_reader_that_goes_away_ends_a_command_without_a_word():
    """As `clean-swarm list mechanisms | head -1` does."""
    line = [sys.executable, "-m", "clean_swarm_env", "list", "mechanisms"]
    process = subprocess.Popen(line, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.close()
    assert process.stderr.read() == ""
    assert process.wait(timeout=120) == 1


@contextmanager
def full_disk(most: int):
    """Let no file grow beyond that number of bytes, as on a disk that is full then."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_full_disk_is_one_line_and_what_was_done_stays(fake_missions, tmp_path):
    words = ("evaluate", "--scenarios", 8, "--workers", 1, "--output")
    with full_disk(16_000):
        code, _, err = command(*words, tmp_path / "r")
    assert code == 1
    assert "cannot be written (File too large); earlier results stay" in err
    assert not list((tmp_path / "r").glob(".*"))
    done(*words, tmp_path / "r", "--resume")
    done(*words, tmp_path / "whole")
    assert rows(tmp_path / "r") == rows(tmp_path / "whole")


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_what_is_promised_to_be_kept_is_on_the_disk_before_it_counts(tmp_path, monkeypatch):
    results = Results(RunFolder(tmp_path / "r", IDENTITY, resume=False))
    names = []  # of the files that are brought to the disk
    monkeypatch.setattr(os, "fsync", lambda number: names.append(Path(os.readlink(f"/proc/self/fd/{number}")).name))
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
