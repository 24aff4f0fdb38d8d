"""Workers that die in any phase: all runs come back, or one named error does; nothing hangs."""

import multiprocessing
import os
import signal
from collections.abc import Iterator
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.train.cli.test_endings import rows, start
from tests.train.running.test_processes import Some, keys
from train.running.processes import rounds

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
EVERY = {(str(number), name) for number in range(3) for name in "abc"}


@contextmanager
def no_hang(seconds: int) -> Iterator[None]:
    """Fail after so many seconds."""

    def fail(*_: object) -> None:
        raise TimeoutError(f"nothing for {seconds} s")

    before = signal.signal(signal.SIGALRM, fail)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def kill_one() -> None:
    worker = multiprocessing.active_children()[0]
    os.kill(worker.pid, signal.SIGKILL)
    worker.join()


def all_or_named(done) -> None:
    """Do three tasks: all their runs come, unless a worker is said to have been killed."""
    found, why = [], ""
    try:
        found.extend(done([Some(name) for name in "abc"]))
    except BrokenProcessPool as error:
        why = str(error)
    assert keys(found) <= EVERY
    assert len(found) == len(EVERY) or "killed" in why


def test_a_worker_that_dies_at_its_imports():
    with no_hang(120), rounds(2) as done:
        kill_one()
        all_or_named(done)


def test_all_workers_die_at_their_imports():
    with no_hang(120), rounds(2) as done:
        kill_one()
        kill_one()
        all_or_named(done)


def test_a_worker_that_dies_while_it_waits_for_tasks():
    with no_hang(120), rounds(2) as done:
        assert len(keys(done([Some(name) for name in "ab"]))) == 6
        kill_one()
        all_or_named(done)


def test_a_worker_that_dies_after_its_last_task_disturbs_nobody():
    with no_hang(120), rounds(2) as done:
        assert len(keys(done([Some(name) for name in "ab"]))) == 6
        kill_one()


def children(process) -> list[str]:
    listed = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    with suppress(OSError):
        found = listed.read_text().split()
        return [child for child in found if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()]
    return []


@pytest.mark.skipif(not Path("/proc").exists(), reason="reads /proc")
def test_a_command_whose_worker_dies_at_its_imports_ends_and_goes_on(tmp_path):
    words = ("--scenarios", "4", "--output", "r", "--workers", "2")
    with no_hang(240):
        process = start(tmp_path, *words, seconds="0")
        while not children(process):
            assert process.poll() is None
        os.kill(int(children(process)[0]), signal.SIGKILL)
        _, err = process.communicate()
        assert process.returncode == 0 or (process.returncode == 1 and "a worker process was killed" in err)
        assert "Traceback" not in err
        assert start(tmp_path, *words, "--resume", seconds="0").wait() == 0
        assert len(rows(tmp_path / "r")) == 1 + 8
