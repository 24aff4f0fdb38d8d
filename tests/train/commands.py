"""Runs the command line for tests: in the process of the test, or in one of its own on missions that take no time."""

import csv
import io
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from functools import partial
from multiprocessing import Pipe, get_context
from pathlib import Path
from typing import Any, TypeVar

import pytest

from selector.configurations.library import library_of
from selforg import plugins
from selforg.registry import REGISTRIES, Registry
from tests.paths import ROOT
from tests.train import fake_mission
from tests.train.waiting import until
from train import cli
from train.evaluation import comparison, pipeline

T = TypeVar("T")


def run(*words: object) -> int:
    """Run a command in this process and return its exit code; it prints where the test prints."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["clean-swarm", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
    return int(ended.value.code or 0)


def command(*words: object) -> tuple[int, str, str]:
    """Run a command in this process; return its exit code, its output and its errors."""
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as err:
        code = run(*words)
    return code, out.getvalue(), err.getvalue()


def done(*words: object) -> str:
    """Run a command that has to succeed and return its output."""
    code, out, err = command(*words)
    assert code == 0, err
    return out


def refused(*words: object) -> str:
    """Run a command that has to be refused, with code 2 and nothing but one line on the standard error; return it."""
    code, out, err = command(*words)
    assert (code, out, err.count("\n")) == (2, "", 1), err
    assert err.startswith("error: ")
    return err


def shipped(registry: Registry[Any]) -> dict[str, Any]:
    """Return the classes of a registry that are ours: files of tests register others when they are imported."""
    return {name: cls for name, cls in registry._classes.items() if not plugins.is_own(cls)}


def apart(work: Callable[[], T], *places: Path) -> T:
    """Return what a function returns in a fork of this process, where the plug-ins in `places` are installed.

    What it imports, registers and changes ends with the fork.
    """
    if not hasattr(os, "fork"):
        pytest.skip("needs a system that forks")
    receiver, sender = Pipe(duplex=False)

    def send() -> None:
        for registry in REGISTRIES:
            registry._classes = shipped(registry)
        sys.path[:0] = map(str, places)
        for forget in (plugins.installed.cache_clear, plugins._loaded.clear, library_of.cache_clear):
            forget()
        sender.send(work())

    process = get_context("fork").Process(target=send)
    process.start()
    sender.close()
    with receiver:
        answer = receiver.recv()  # EOFError: the function raised, and its traceback is in the output
    process.join()
    return answer


@contextmanager
def faked_missions(trials: Callable[..., object] = fake_mission.trials) -> Iterator[None]:
    """Let missions of experiments take no time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(comparison, "TrialTask", partial(fake_mission.FakeTask, trials=trials))
        patch.setattr(pipeline, "compiled_before", lambda: True)  # a warm-up would be one more fake mission
        yield


def start(directory: Path, *words: str, seconds: str = "0.1") -> "subprocess.Popen[str]":
    """Start an evaluation on missions of that length, in a process group of its own, as a terminal does."""
    line = [sys.executable, "-m", "tests.train.fake_mission", "evaluate", *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "FAKE_SECONDS": seconds}
    pipes = {"stderr": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    return subprocess.Popen(line, cwd=directory, env=environment, start_new_session=True, **pipes)


def finished(directory: Path) -> int:
    """Return the number of runs that are kept."""
    journal = directory / "runs.jsonl"
    return journal.read_text().count("\n") if journal.exists() else 0


def wait_for_runs(process: "subprocess.Popen[str]", directory: Path, count: int) -> None:
    """Wait until there is a directory of results, and that number of runs is kept."""
    until(lambda: (directory.exists() and finished(directory) >= count) or process.poll() is not None, 600.0)
    assert process.poll() is None


def living(group: int) -> list[str]:
    """Return the commands of the processes of a group that have not ended."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            state, _, of_group = (folder / "stat").read_text().rpartition(")")[2].split()[:3]
            if int(of_group) == group and state != "Z":
                found.append((folder / "cmdline").read_text())
        except OSError:  # it has just ended
            continue
    return found


def wait_for_end(group: int) -> None:
    """Wait until no process of a group lives; the resource tracker of multiprocessing ends when it notices."""
    until(lambda: not living(group), 60.0)


def rows(directory: Path) -> list[str]:
    """Return the lines of the runs in a directory, without the times that they took."""
    return [line.rpartition(",")[0] for line in (directory / "runs.csv").read_text().splitlines()]


def runs(directory: Path) -> list[dict[str, str]]:
    """Return the runs in a directory: column -> cell, without the times that they took."""
    with (directory / "runs.csv").open(newline="") as file:
        return [{name: cell for name, cell in row.items() if name != "wall_s"} for row in csv.DictReader(file)]


def changed(source: Path, directory: Path, change: Callable[[Any], object]) -> Path:
    """Copy results with a change of what their manifest says and return the directory."""
    shutil.copytree(source, directory)
    manifest = json.loads((directory / "manifest.json").read_text())
    change(manifest)
    (directory / "manifest.json").write_text(json.dumps(manifest))
    return directory


def cut(source: Path, directory: Path, kept: slice) -> Path:
    """Copy results with a part of their finished runs only and return the directory."""
    shutil.copytree(source, directory)
    journal = directory / "runs.jsonl"
    journal.write_text("".join(journal.read_text().splitlines(keepends=True)[kept]))
    return directory
