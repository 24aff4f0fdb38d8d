"""Worker processes: each run comes back when it is done, and a kill or Ctrl-C costs none that is."""

import csv
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
import yaml

from tests.paths import ROOT
from tests.train.records import record
from train.running.engine import WorkerLost
from train.running.processes import Processes
from train.running.runs import RunKey, RunRecord

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
    """A task of three runs; before the third it may end its process (`times` at most), fail or wait."""

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
            yield record(str(number), self.name)


def each_done(tasks, engine):
    with engine.rounds() as done:
        yield from done(tasks)


def keys(runs) -> set[tuple[str, str]]:
    return {run.key for run in runs}


def test_all_runs_of_all_tasks_come_back():
    tasks = [Some(str(number)) for number in range(5)]
    expected = {(str(number), task.name) for task in tasks for number in range(3)}
    for workers in (1, 2, 8):
        found = list(each_done(tasks, Processes(workers)))
        assert len(found) == 15
        assert keys(found) == expected


@pytest.mark.parametrize("times", [1, 2])
def test_what_a_task_lacks_is_run_again_when_its_worker_dies(tmp_path, times):
    tasks = [Some("a", "die", tmp_path / "log", times), Some("b")]
    found = list(each_done(tasks, Processes(2)))
    assert sorted(run.key for run in found) == [(str(number), name) for number in range(3) for name in "ab"]
    assert (tmp_path / "log").read_text().split() == ["0", "1", *["2"] * (times + 1)]


def test_a_task_that_loses_three_workers_is_named_and_costs_no_run_that_was_done(tmp_path):
    found = []
    with pytest.raises(WorkerLost, match="scenario 2, condition a: its worker died 3 times"):
        found.extend(each_done([Some("a", "die", tmp_path / "log", 9), Some("b", "wait")], Processes(2)))
    assert {("0", "a"), ("1", "a")} <= keys(found) <= {("0", "a"), ("1", "a"), ("0", "b"), ("1", "b")}
    assert (tmp_path / "log").read_text().count("2") == 3


def test_workers_that_die_between_rounds_are_replaced(tmp_path):
    with Processes(2).rounds() as done:
        first = list(done([Some("a"), Some("b")]))
        for worker in multiprocessing.active_children():
            worker.kill()
            worker.join()
        second = list(done([Some("c"), Some("d")]))
    assert len(first) == len(second) == 6


def test_an_error_in_a_task_is_raised_and_ends_the_others():
    began = time.monotonic()
    with pytest.raises(ValueError, match="no third run"):
        list(each_done([Some("a", "fail"), Some("b", "wait")], Processes(2)))
    assert time.monotonic() - began < 60.0


def rows(directory: Path) -> list[dict[str, str]]:
    with (directory / "runs.csv").open(newline="") as file:
        return [{k: v for k, v in row.items() if k != "wall_s"} for row in csv.DictReader(file)]


def command(folder: Path, output: str) -> list[str]:
    (folder / "uneven.yaml").write_text(yaml.safe_dump(FAMILY))
    words = ["evaluate", "--family", str(folder / "uneven.yaml"), "--scenarios", str(SCENARIOS), "--workers", "2"]
    words += ["--strategy", "fixed:RepulsionGradient", "--strategy", "Random", "--output", str(folder / output)]
    return [sys.executable, "-m", "clean_swarm_env", *words]


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("what", ["kill", "Ctrl-C"])
def test_no_finished_mission_of_a_family_is_lost(tmp_path, what):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": environment}
    process = subprocess.Popen(command(tmp_path, "cut"), start_new_session=True, **pipes)
    journal, end = tmp_path / "cut" / "runs.jsonl", time.monotonic() + 120.0
    while not journal.exists() or journal.read_text().count("\n") < 2:
        assert process.poll() is None
        assert time.monotonic() < end, "no run finished"
        time.sleep(0.01)
    if what == "kill":
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        workers = [child for child in children if "spawn_main" in Path(f"/proc/{child}/cmdline").read_text()]
        os.kill(int(workers[0]), signal.SIGKILL)
    else:
        os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    if what == "kill":
        assert process.returncode == 0, err
        subprocess.run(command(tmp_path, "whole"), check=True, capture_output=True, env=environment)
        assert rows(tmp_path / "cut") == rows(tmp_path / "whole")
        assert len(rows(tmp_path / "whole")) == 3 * SCENARIOS
        return
    assert process.returncode == 130
    kept = rows(tmp_path / "cut")
    of_condition = [sum(row["condition"] == name for row in kept) for name in {row["condition"] for row in kept}]
    assert len(kept) >= 2
    assert max(of_condition) < SCENARIOS, "each worker had one task, which was not over"
    assert re.search(rf"{len(kept)} of {3 * SCENARIOS} runs are kept", err)
    assert "Traceback" not in err
