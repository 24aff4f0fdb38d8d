"""Workers that die in any phase: all runs come back, and nothing hangs."""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.train.cli.test_endings import rows, start
from tests.train.running.test_processes import Some, keys
from train.running.processes import Processes

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
EVERY = {(str(number), name) for number in range(3) for name in "abc"}


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


def kill_first(count: int) -> None:
    """Kill this number of workers of the process as soon as they are there."""
    killed: set[str] = set()
    while len(killed) < count:
        for worker in set(children(os.getpid())) - killed:
            if len(killed) < count:
                os.kill(int(worker), signal.SIGKILL)
                killed.add(worker)


def all_come(done) -> None:
    found = list(done([Some(name) for name in "abc"]))
    assert keys(found) == EVERY
    assert len(found) == len(EVERY)


@pytest.mark.parametrize("count", [1, 2])
def test_workers_that_die_at_their_imports_are_replaced(count):
    killing = threading.Thread(target=kill_first, args=(count,), daemon=True)
    with no_hang(120), Processes(2).rounds() as done:
        killing.start()
        all_come(done)
        assert not killing.is_alive()


def test_a_worker_that_dies_while_it_waits_for_tasks_is_replaced():
    with no_hang(120), Processes(2).rounds() as done:
        for _ in range(2):
            all_come(done)
            kill_first(1)


def children(process: int) -> list[str]:
    with suppress(OSError):
        found = [
            child
            for task in Path(f"/proc/{process}/task").iterdir()
            for child in (task / "children").read_text().split()
        ]
        return [child for child in found if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()]
    return []


def test_a_command_whose_worker_dies_at_its_imports_ends_and_goes_on(tmp_path):
    words = ("--scenarios", "4", "--output", "r", "--workers", "2")
    with no_hang(240):
        process = start(tmp_path, *words, seconds="0")
        while not children(process.pid):
            assert process.poll() is None
        os.kill(int(children(process.pid)[0]), signal.SIGKILL)
        _, err = process.communicate()
        assert process.returncode == 0, err
        assert "Traceback" not in err
        assert start(tmp_path, *words, "--resume", seconds="0").wait() == 0
        assert len(rows(tmp_path / "r")) == 1 + 8
