"""Compiling before the runs: once, said on the standard error, and not again."""

import fcntl
import os
import subprocess
import sys
import time

import pytest

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning import warm_up
from clean_swarm_env.learning.batch import Batch
from selforg.compiler import cache
from selforg.compiler.decorators import KERNELS
from selforg.gradients.store import tables
from tests.train import fake_mission
from tests.train.commands import command, done, faked_missions
from train.evaluation import pipeline
from train.running.trial_task import TrialTask


@pytest.fixture(autouse=True)
def _alone(monkeypatch):
    monkeypatch.setattr(warm_up, "usable_cpus", lambda: 1)


LINE = "compiling this copy of the package for this machine, once: about a minute\n"


@pytest.fixture
def task():
    """A mission of the world."""
    mission = MissionConfig()
    one = Scenario("1", 0, mission, random_start(mission, 0, 0))
    return TrialTask("table1", 0, (one,), "RepulsionGradient-view1.5", "MaxScore")


@pytest.mark.parametrize(("compiled", "expected"), [(False, [300.0, 3000.0]), (True, [3000.0])])
def test_an_evaluation_compiles_in_one_process_before_the_workers_start(compiled, expected, monkeypatch, tmp_path):
    limits = []

    def run(scenarios, *given):
        limits.extend(scenario.mission.time_limit for scenario in scenarios)
        return fake_mission.trials(scenarios, *given)

    words = (
        "evaluate",
        "--condition",
        "RepulsionGradient-view1.5",
        "--scenarios",
        1,
        "--workers",
        1,
        "--output",
        tmp_path,
    )
    with faked_missions(run):
        monkeypatch.setattr(pipeline, "compiled_before", lambda: compiled)
        code, _, err = command(*words)
        assert (code, limits) == (0, expected)
        assert (LINE in err) is not compiled
        done(*words, "--resume")
        assert limits == expected, "nothing is compiled for an evaluation that is done"


def test_compiled_code_is_looked_for_by_what_it_is_compiled_from(monkeypatch, tmp_path):
    monkeypatch.setattr(cache, "cache_directory", lambda: tmp_path)
    assert not warm_up.compiled_before()
    (tmp_path / f"{warm_up.KERNELS[warm_up.EVERY_MISSION]._cache._stem()}-types").touch()
    assert warm_up.compiled_before()
    monkeypatch.setattr(warm_up, "cache_directory", lambda: None)
    assert warm_up.compiled_before()  # nothing can be kept: each process compiles for itself


def test_the_warm_up_calls_a_kernel_that_no_first_second_needs(task, monkeypatch):
    called, compiled = [], tables.rebuild
    monkeypatch.setattr(tables, "rebuild", lambda *given: called.append(given) or compiled(*given))
    task.beginning().run()
    assert called


def test_python_says_it_too_once_in_a_process_and_can_be_silenced(monkeypatch, capsys):
    monkeypatch.setattr(warm_up, "compiled_before", lambda: False)
    for quiet, said in (("", LINE), ("1", "")):
        monkeypatch.setattr(warm_up, "_checked", [])
        monkeypatch.setenv(warm_up.SILENCED, quiet)
        for _ in range(2):
            Batch(mission={"base": "table1", "task": {"garbage": {"count": 1}}})
        assert capsys.readouterr().err == said


LISTED_LINES = warm_up.FIRST_KERNELS.read_text(encoding="utf-8").splitlines()
LISTED = """
import clean_swarm_env.learning.batch as batch
from clean_swarm_env.learning.warm_up import run_through
from benchmarks.first_start import compiled_lines
run_through(batch.Batch())
print(*compiled_lines(), sep="\\n")
"""


def test_the_list_names_kernels_that_are_there_and_that_of_every_mission_last():
    names = [line.partition(" ")[0] for line in LISTED_LINES]
    assert set(names) <= KERNELS.keys()
    assert names[-1] == warm_up.EVERY_MISSION


@pytest.mark.long
def test_the_list_has_the_kernels_that_the_first_mission_calls():
    told = subprocess.check_output([sys.executable, "-c", LISTED], text=True).splitlines()
    assert sorted(told) == sorted(LISTED_LINES), "python -m benchmarks.first_start --list makes it again"


@pytest.fixture
def compiled(monkeypatch):
    """The lines that this process compiles, which are not compiled; the first one cannot be."""
    lines = []

    def note(line):
        lines.append(line)
        if len(lines) == 1:
            raise RuntimeError("no room")

    monkeypatch.setattr(warm_up, "compile_line", note)
    return lines


def test_each_kernel_is_taken_by_one_process_and_one_that_fails_stops_nobody(compiled, tmp_path):
    (tmp_path / "3").touch()
    for _ in range(2):
        warm_up.compile_share(str(tmp_path))
        assert compiled == [line for number, line in enumerate(LISTED_LINES) if number != 3]


def test_a_helper_whose_parent_has_gone_ends(compiled, tmp_path):
    warm_up.compile_share(str(tmp_path), parent=os.getpid())
    assert compiled == []


def test_a_list_of_other_sources_is_no_error(monkeypatch, tmp_path):
    (tmp_path / "list").write_text("no.such.kernel int64\nselforg.space.shorten complex128\n\n")
    monkeypatch.setattr(warm_up, "FIRST_KERNELS", tmp_path / "list")
    warm_up.compile_share(str(tmp_path))


@pytest.mark.parametrize("helper", ["raise SystemExit(3)", "import time\ntime.sleep(60)"], ids=["dies", "hangs"])
def test_helpers_that_die_or_hang_hold_nothing_up(helper, compiled, monkeypatch):
    monkeypatch.setattr(warm_up, "usable_cpus", lambda: 3)
    monkeypatch.setattr(warm_up, "HELPER", helper)
    monkeypatch.setattr(warm_up, "HELPERS_WAIT", 0.1)
    began = time.monotonic()
    warm_up.compile_listed()
    assert time.monotonic() - began < 30.0
    assert len(compiled) == len(LISTED_LINES)


def test_helpers_end_with_an_interruption(monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    started = []
    monkeypatch.setattr(warm_up, "usable_cpus", lambda: 2)
    monkeypatch.setattr(warm_up, "HELPER", "import time\ntime.sleep(60)")
    monkeypatch.setattr(warm_up, "compile_share", interrupted)
    monkeypatch.setattr(
        warm_up, "Popen", lambda *words, **more: started.append(subprocess.Popen(*words, **more)) or started[-1]
    )
    with pytest.raises(KeyboardInterrupt):
        warm_up.compile_listed()
    assert [one.poll() is not None for one in started] == [True]


@pytest.mark.parametrize(("program", "cpus"), [("/usr/bin/blender", 4), (sys.executable, 1)])
def test_no_other_program_is_started_and_none_on_one_core(program, cpus, monkeypatch):
    monkeypatch.setattr(warm_up, "usable_cpus", lambda: cpus)
    monkeypatch.setattr(sys, "executable", program)
    monkeypatch.setattr(warm_up, "Popen", lambda *_, **__: pytest.fail("started"))
    warm_up.compile_listed()


def test_a_system_that_allows_no_more_processes_leaves_all_to_the_work(compiled, monkeypatch):
    def refused(*_, **__):
        raise OSError("no more processes")

    monkeypatch.setattr(warm_up, "usable_cpus", lambda: 2)
    monkeypatch.setattr(warm_up, "Popen", refused)
    warm_up.compile_listed()
    assert compiled == []


def test_others_wait_for_the_one_that_compiles(monkeypatch, tmp_path):
    monkeypatch.setattr(warm_up, "cache_directory", lambda: tmp_path)
    held, again = warm_up.one_process(), warm_up.one_process()
    with held, again, (tmp_path / "compiling.lock").open() as lock, pytest.raises(BlockingIOError):
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)  # as another process does
    with (tmp_path / "compiling.lock").open() as lock:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
