"""Worker processes: each run comes back when it is done, and a kill or Ctrl-C costs none that is."""

import csv
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml

from tests.paths import ROOT
from tests.train.records import record
from train.running.processes import each_done
from train.running.runs import RunRecord

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
    """A task of three runs; before the third it may end its process, fail or wait."""

    name: str
    then: str = ""

    def each(self) -> Iterator[RunRecord]:
        for number in range(3):
            if number == 2 and self.then == "die":
                os.kill(os.getpid(), signal.SIGKILL)
            if number == 2 and self.then == "fail":
                raise ValueError("no third run")
            if number == 2 and self.then == "wait":
                time.sleep(600.0)
            yield record(str(number), self.name)


def keys(runs) -> set[tuple[str, str]]:
    return {run.key for run in runs}


def test_all_runs_of_all_tasks_come_back():
    tasks = [Some(str(number)) for number in range(5)]
    expected = {(str(number), task.name) for task in tasks for number in range(3)}
    for workers in (1, 2, 8):
        found = list(each_done(tasks, workers))
        assert len(found) == 15
        assert keys(found) == expected


def test_a_worker_that_dies_in_the_middle_of_a_task_costs_no_run_that_was_done():
    found = []
    with pytest.raises(BrokenProcessPool, match="a worker process was killed"):
        found.extend(each_done([Some("a", "die"), Some("b", "wait")], 2))
    assert {("0", "a"), ("1", "a")} <= keys(found) <= {("0", "a"), ("1", "a"), ("0", "b"), ("1", "b")}


def test_an_error_in_a_task_is_raised_and_ends_the_others():
    began = time.monotonic()
    with pytest.raises(ValueError, match="no third run"):
        list(each_done([Some("a", "fail"), Some("b", "wait")], 2))
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
    assert process.returncode == (1 if what == "kill" else 130)
    kept = rows(tmp_path / "cut")
    of_condition = [sum(row["condition"] == name for row in kept) for name in {row["condition"] for row in kept}]
    assert len(kept) >= 2
    assert max(of_condition) < SCENARIOS, "each worker had one task, which was not over"
    assert re.search(rf"{len(kept)} of {3 * SCENARIOS} runs are kept", err)
    assert "Traceback" not in err
    if what == "Ctrl-C":  # goes on in the same way
        return
    for words in ([*command(tmp_path, "cut"), "--resume"], command(tmp_path, "whole")):
        subprocess.run(words, check=True, capture_output=True, env=environment)
    assert rows(tmp_path / "cut") == rows(tmp_path / "whole")
    assert len(rows(tmp_path / "whole")) == 3 * SCENARIOS
