"""A task of a file gives a compiled step of its own: robots that tire (examples/tiring.py)."""

import copy
import re

import numpy as np
import pytest

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import TASKS
from selforg.compiler.records import Packed
from selforg.compiler.switches import BY_ADDRESS
from selforg.plugins import module_of
from tests.clean_swarm_env.courses import begun
from tests.paths import ROOT


@pytest.fixture
def tiring(monkeypatch):
    monkeypatch.setattr(TASKS, "_classes", dict(TASKS._classes))
    module = module_of(str(ROOT / "examples" / "tiring.py"))
    TASKS._classes["Tiring"] = module.Tiring  # a module registers only once
    return module


def step(batch):
    return batch.step(np.tile(batch.choices.default, (batch.rows, 1))).observations.copy()


def test_robots_tire_and_copies_and_states_know_how_tired_they_are(tiring):
    batch, rested = (begun(Batch(name, 2), [1, 2]) for name in ("Tiring", "Foraging"))
    worn = batch.worlds.task.tired.record.worn
    for _ in range(10):
        step(batch), step(rested)
    assert (worn > 3.0).all()
    assert (batch.worlds.floor.drive.speed < 0.7 * rested.worlds.floor.drive.speed).any()
    state, other = batch.get_state(), copy.deepcopy(batch)
    seen = step(batch)
    assert np.array_equal(step(other), seen)
    batch.set_state(state)
    assert np.array_equal(step(batch), seen)
    batch.reset([1, 2])
    assert not worn.any()


@pytest.mark.skipif(not BY_ADDRESS, reason="called by address only")
def test_an_array_that_its_author_made_too_short_is_one_line(tiring):
    batch = Batch("Tiring", 2)
    task, rows = batch.worlds.task, batch.rows
    task.tired = Packed(tiring.Tired(np.zeros(rows // 2)))  # of the robots of one world
    line = f"step tire: expected at least {rows} rows in Tired.worn, got {rows // 2}"
    with pytest.raises(ValueError, match=re.escape(line)):
        batch.worlds.tick()
