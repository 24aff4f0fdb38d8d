"""A Dask cluster on loopback, for tests."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from tests.paths import ROOT

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "FAKE_SECONDS": "0.3"}
QUIET = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


@dataclass
class Cluster:
    """A scheduler and its workers, each with its nanny."""

    address: str
    scheduler: subprocess.Popen[bytes]
    nannies: list[subprocess.Popen[bytes]]


def until(what: Callable[[], object]) -> None:
    """Wait until something is so."""
    end = time.monotonic() + 180.0
    while not what():
        assert time.monotonic() < end
        time.sleep(0.02)


@contextmanager
def loopback_cluster(folder: Path, workers: int = 2) -> Iterator[Cluster]:
    """Yield a cluster that runs in a folder."""
    file = folder / "scheduler.json"
    words = ("--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0", "--scheduler-file", str(file))
    with ExitStack() as stack:

        def start(program: str, *more: str) -> subprocess.Popen[bytes]:
            command = [sys.executable, "-m", f"distributed.cli.{program}", *words, *more]
            process = subprocess.Popen(command, cwd=folder, env=ENVIRONMENT, **QUIET)
            stack.enter_context(process)
            stack.callback(process.terminate)
            return process

        scheduler = start("dask_scheduler", "--port", "0")
        until(lambda: file.exists() and file.read_text().endswith("}"))
        nannies = [start("dask_worker", "--nthreads", "1") for _ in range(workers)]
        yield Cluster(json.loads(file.read_text())["address"], scheduler, nannies)
