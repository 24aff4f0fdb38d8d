"""Compiling before the runs: once, said on the standard error, and not again."""

import pytest

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from train.running import warm_up as preparing
from train.running.runs import RunTask


@pytest.fixture
def task():
    mission = MissionConfig()
    return RunTask("table1", "1", 0, "RepulsionGradient", mission, random_start(mission, 0, 0), {})


def _runner(limits):
    from tests.train import fake_mission

    def run(mission, *given):
        limits.append(mission.time_limit)
        return fake_mission.run_mission(mission, *given)

    return run


def test_the_first_run_of_all_compiles_and_says_so(task, monkeypatch, capsys):
    limits: list[float] = []
    monkeypatch.setattr(preparing, "compiled_before", lambda: False)
    preparing.compile_first(task, _runner(limits))
    assert limits == [1.0]
    assert capsys.readouterr().err == "compiling for this machine, once: about a minute\n"
    assert task.mission.time_limit == 3000.0


def test_what_is_compiled_is_not_run_for_nothing(task, monkeypatch, capsys):
    limits: list[float] = []
    monkeypatch.setattr(preparing, "compiled_before", lambda: True)
    preparing.compile_first(task, _runner(limits))
    assert limits == []
    assert capsys.readouterr().err == ""


def test_compiled_code_is_looked_for_beside_the_package(monkeypatch, tmp_path):
    package = tmp_path / "selforg"
    (package / "__pycache__").mkdir(parents=True)
    (package / "__init__.py").touch()
    spec = type("Spec", (), {"submodule_search_locations": [str(package)]})
    monkeypatch.setattr(preparing, "find_spec", lambda name: spec)
    assert not preparing.compiled_before()
    (package / "__pycache__" / "kernel.py311.nbi").touch()
    assert preparing.compiled_before()
