"""A Dask cluster on loopback for tests, and evaluations of fake missions that may run on it."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from tests.paths import ROOT
from tests.train.commands import rows
from tests.train.waiting import until

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "FAKE_SECONDS": "0.06"}
QUIET = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def evaluate(folder: Path, *words: str, **more: str) -> subprocess.Popen[str]:
    """Start an evaluation of 200 fake missions in eight tasks; `more` are variables of its environment."""
    command = [sys.executable, "-m", "tests.train.fake_mission", "evaluate", "--scenarios", "100", *words]
    pipes = {**QUIET, "stderr": subprocess.PIPE, "env": {**ENVIRONMENT, **more}}
    return subprocess.Popen(command, cwd=folder, text=True, **pipes)


def results(directory: Path) -> tuple[list[str], bytes, bytes]:
    """Return what the results of equal runs have in common: the rows without their wall time, summary and tables."""
    return rows(directory), (directory / "summary.json").read_bytes(), (directory / "table.md").read_bytes()


@dataclass
class Cluster:
    """A scheduler and its workers, each with its nanny."""

    address: str
    scheduler: subprocess.Popen[bytes]
    nannies: list[subprocess.Popen[bytes]]


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
