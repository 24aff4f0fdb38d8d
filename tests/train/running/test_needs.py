"""What missions need is estimated before they start, said in words, and refused where the machine is too small."""

import pytest

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.config.types import ConfigurationError
from train.evaluation.repeat import record_run
from train.running import needs
from train.running.needs import Machine, check_needs, needs_of
from train.running.trial_task import TrialTask

LARGE = {"world": {"width": 1000.0, "height": 1000.0}, "robots": {"count": 2000}}


def mission(**changes):
    return MissionConfig.model_validate(changes)


@pytest.mark.parametrize(
    ("largest", "missions", "worlds", "expected"),
    [
        (mission(**LARGE, delivery={"loss": 0.1}), 1, 1, r"3\.0 GB|of memory"),
        (mission(time_limit=1e7), 10_000, 1, r"at most 7\.0 days of time, got about"),
        (mission(**LARGE, delivery={"loss": 0.1}, time_limit=60.0), 1, 25, "of memory"),
    ],
)
def test_what_is_too_much_is_refused_in_words_unless_forced(largest, missions, worlds, expected, monkeypatch):
    monkeypatch.setattr(needs, "memory_of_machine", lambda: 1e9)
    with pytest.raises(ConfigurationError, match=expected) as caught:
        check_needs(largest, missions, Machine(2), worlds)
    assert f"of up to {largest.rows} robots, 10 items and" in str(caught.value)
    assert "--force" in str(caught.value)
    check_needs(largest, missions, Machine(2, forced=True), worlds)


def test_periods_in_which_nobody_can_interrupt_are_refused(monkeypatch):
    monkeypatch.setattr(needs, "memory_of_machine", lambda: 1e12)
    crowd = mission(**LARGE, delivery={"loss": 0.1}, time_limit=60.0)
    with pytest.raises(ConfigurationError, match="in which Ctrl-C waits"):
        check_needs(crowd, 1, Machine(), 2)


def test_what_ships_needs_little(monkeypatch):
    monkeypatch.setattr(needs, "memory_of_machine", lambda: 2e9)
    check_needs(mission(), 200, Machine(2))
    assert needs_of(mission()).ticks == 15_000


def test_a_container_has_its_own_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(needs, "CONTROL_GROUP", tmp_path / "memory.max")
    whole = needs.memory_of_machine()
    for text, expected in (("max\n", whole), ("1000000\n", 1e6)):
        (tmp_path / "memory.max").write_text(text)
        assert needs.memory_of_machine() == expected


def test_a_run_that_this_machine_is_too_small_for_is_not_repeated(tmp_path, monkeypatch):
    one = Scenario("1", 1, mission(), random_start(mission(), 1, 0))
    task = TrialTask("mine", 1, (one,), "c", "MaxScore")
    monkeypatch.setattr(needs, "memory_of_machine", lambda: 1e6)
    with pytest.raises(ConfigurationError, match=r"1 missions, 1 at a time, .* the run cannot be repeated here"):
        record_run(task, tmp_path / "run.swarm")
    assert not list(tmp_path.iterdir())
