"""Worker processes: each run comes back when it is done, and a kill in any phase or Ctrl-C costs none that is."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from multiprocessing.context import SpawnProcess
from pathlib import Path

import pytest
import yaml

from tests.paths import ROOT
from tests.train.commands import finished, runs
from tests.train.records import record
from tests.train.waiting import until
from train.running import pulse
from train.running.engine import WorkerLost
from train.running.processes import Processes
from train.running.runs import RunKey, RunRecord

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
FAMILY = {
    "name": "uneven",
    "description": "Missions of very different lengths.",
    "mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 20_000.0},
    "robots": [2, 2],
    "items": [1, 30],
}
SCENARIOS = 6


@dataclass(frozen=True)
class Some:
    """A task of three runs, each of which tells ten seconds; before the third it may die (`times`), fail or wait."""

    name: str
    then: str = ""
    log: Path = Path()
    times: int = 0
    numbers: tuple[int, ...] = (0, 1, 2)

    @property
    def keys(self) -> tuple[RunKey, ...]:
        return tuple((str(number), self.name) for number in self.numbers)

    def without(self, done) -> "Some":
        return replace(self, numbers=tuple(number for number in self.numbers if (str(number), self.name) not in done))

    def each(self) -> Iterator[RunRecord]:
        for number in self.numbers:
            if self.then == "die":
                with self.log.open("a") as log:
                    log.write(f"{number} ")
                if number == 2 and self.log.read_text().count("2") <= self.times:
                    os.kill(os.getpid(), signal.SIGKILL)
            if number == 2 and self.then == "fail":
                raise ValueError("no third run")
            if number == 2 and self.then == "wait":
                time.sleep(600.0)
            if multiprocessing.parent_process() is not None:
                pulse.TELL_EVERY = -1.0  # at once
            pulse.tell(10.0)
            yield record(str(number), self.name)


def keys(records) -> list[RunKey]:
    return sorted(record.key for record in records)


def all_of(names: str) -> list[RunKey]:
    return [(str(number), name) for number in range(3) for name in names]


def tasks_of(names: str) -> list[Some]:
    return [Some(name) for name in names]


def each_done(tasks, workers: int) -> Iterator[RunRecord]:
    with Processes(workers).rounds() as done:
        yield from done(tasks)


def test_all_runs_come_back_and_tell_how_far_they_are_also_where_workers_die(tmp_path, monkeypatch):
    monkeypatch.setattr(pulse, "TELL_EVERY", -1.0)
    tasks, heard = [Some("a", "die", tmp_path / "log", times=2), Some("b")], []
    with pulse.listening(heard.append):
        assert keys(each_done(tasks, 2)) == all_of("ab")
    assert (tmp_path / "log").read_text().split() == ["0", "1", "2", "2", "2"]
    assert heard == [10.0] * 6


@pytest.mark.parametrize(("workers", "names"), [(1, "abcde"), (2, "a")])
def test_a_single_worker_or_task_needs_no_other_process(workers, names, monkeypatch):
    monkeypatch.setattr(multiprocessing, "get_context", lambda _: pytest.fail("started"))
    assert keys(each_done(tasks_of(names), workers)) == all_of(names)
    with pytest.raises(ValueError, match="no third run"):
        list(each_done([Some("a", "fail")], workers))


@pytest.mark.long
def test_a_task_that_loses_three_workers_is_named_and_costs_no_run_that_was_done(tmp_path):
    found = []
    with pytest.raises(WorkerLost, match="scenario 2, condition a: its worker died 3 times"):
        found.extend(each_done([Some("a", "die", tmp_path / "log", times=9), Some("b", "wait")], 2))
    assert {("0", "a"), ("1", "a")} <= set(keys(found)) <= {("0", "a"), ("1", "a"), ("0", "b"), ("1", "b")}
    assert (tmp_path / "log").read_text().count("2") == 3


@pytest.mark.long
def test_an_error_in_a_task_is_raised_and_ends_the_others():
    with no_hang(240), pytest.raises(ValueError, match="no third run"):
        list(each_done([Some("a", "fail"), Some("b", "wait")], 2))


@LINUX
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGALRM"])
def test_a_signal_waits_until_a_process_has_got_all_that_it_reads(name, monkeypatch):
    """SIGALRM: `Interruption` tries a signal again that came during an import."""
    number, started, begin = getattr(signal, name), [], SpawnProcess.start

    def start(process):
        signal.raise_signal(number)
        begin(process)
        started.append(process)

    def end(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(SpawnProcess, "start", start)
    before = signal.signal(number, end)
    try:
        with pytest.raises(KeyboardInterrupt):
            list(each_done(tasks_of("ab"), 2))
    finally:
        signal.signal(number, before)
    assert [process.is_alive() for process in started] == [False]


# Workers that die in any phase


@contextmanager
def no_hang(seconds: int) -> Iterator[None]:
    """Fail after that number of seconds."""

    def fail(*_: object) -> None:
        raise TimeoutError(f"nothing for {seconds} s")

    before = signal.signal(signal.SIGALRM, fail)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def workers_of(process: int) -> list[int]:
    """Return the worker processes of a process."""
    with suppress(OSError):
        threads = Path(f"/proc/{process}/task").iterdir()
        found = [child for one in threads for child in (one / "children").read_text().split()]
        return [int(child) for child in found if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()]
    return []


def kill_first(count: int) -> None:
    """Kill this number of workers of this process as soon as they are there."""
    killed: set[int] = set()
    while len(killed) < count:
        for worker in [one for one in workers_of(os.getpid()) if one not in killed][: count - len(killed)]:
            os.kill(worker, signal.SIGKILL)
            killed.add(worker)


@LINUX
@pytest.mark.long
@pytest.mark.parametrize("count", [1, 2])
def test_workers_that_die_at_their_imports_are_replaced(count):
    killing = threading.Thread(target=kill_first, args=(count,), daemon=True)
    with no_hang(240), Processes(2).rounds() as done:
        killing.start()
        assert keys(done(tasks_of("abc"))) == all_of("abc")
        assert not killing.is_alive()


@LINUX
@pytest.mark.long
def test_workers_that_die_between_rounds_are_replaced():
    with no_hang(240), Processes(2).rounds() as done:
        for _ in range(2):
            assert keys(done(tasks_of("abc"))) == all_of("abc")
            kill_first(1)
        for worker in multiprocessing.active_children():
            worker.kill()
            worker.join()
        assert keys(done(tasks_of("abc"))) == all_of("abc")


# Commands


def started(folder: Path, output: str) -> subprocess.Popen[str]:
    """Start an evaluation of the family by two workers."""
    (folder / "uneven.yaml").write_text(yaml.safe_dump(FAMILY))
    words = ["evaluate", "uneven.yaml", "--scenarios", str(SCENARIOS), "--workers", "2"]
    words += ["--strategy", "fixed:RepulsionGradient-view0.5", "--strategy", "Random", "--output", output]
    given = {"cwd": folder, "env": {**os.environ, "PYTHONPATH": str(ROOT)}, "stdout": subprocess.DEVNULL}
    command = [sys.executable, "-m", "clean_swarm_env", *words]
    return subprocess.Popen(command, start_new_session=True, stderr=subprocess.PIPE, text=True, **given)


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> list[dict[str, str]]:
    """The rows of a command that nobody disturbs."""
    folder = tmp_path_factory.mktemp("whole")
    assert started(folder, "whole").wait(600) == 0
    return runs(folder / "whole")


@LINUX
@pytest.mark.long
@pytest.mark.parametrize("phase", ["imports", "missions"])
def test_a_command_whose_worker_dies_ends_with_all_missions(tmp_path, phase, whole):
    process, least = started(tmp_path, "cut"), {"imports": 0, "missions": 2}[phase]
    until(lambda: process.poll() is not None or (workers_of(process.pid) and finished(tmp_path / "cut") >= least))
    os.kill(workers_of(process.pid)[0], signal.SIGKILL)
    _, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    assert "Traceback" not in err
    assert runs(tmp_path / "cut") == whole
    assert len(whole) == 3 * SCENARIOS
