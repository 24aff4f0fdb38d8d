"""The benchmark of peers: our own contestants step, one that fails is one line, and the table has a row for each."""

import sys
from pathlib import Path

import pytest

from benchmarks.document import peers
from benchmarks.peers import PEERS, WORLDS, Contestant
from benchmarks.shared.contestants import CONTESTANTS


@pytest.mark.parametrize("name", [name for name in WORLDS if name not in PEERS])
def test_our_contestants_step(name):
    step, ticks = CONTESTANTS[name][0](2)
    step()
    assert ticks == (5 if name == "Batch" else 1)


def test_every_contestant_can_be_made():
    assert set(WORLDS) == set(CONTESTANTS) >= set(PEERS)


def test_a_contestant_that_fails_is_one_line():
    with pytest.raises(ChildProcessError, match=r"^mpe2, 2 worlds: ended with 1$"):
        Contestant.started(Path(sys.executable), "mpe2", 2, 0)


def test_the_table_leaves_out_what_was_not_measured():
    rates = {"tick x 1": 4e4, "tick x 64": 1e5, "Batch x 1": 9e3, "Batch, each tick x 1": 9.0, "VMAS x 64": 5.0}
    run = {"median": rates, "least": rates, "most": rates, "load": {"before": 1.0, "after": 2.0}}
    lines = peers({"peers": {**run, "versions": {"vmas": "1.0"}, "machine": {"cpu": "A", "cores": 2}}})
    assert lines[:2] == ["| | 1 world | 64 |", "|---|---|---|"]
    assert lines[2] == "| ours, `Worlds.tick` | 40,000 (40,000 to 40,000) | 100,000 (100,000 to 100,000) |"
    assert lines[5] == "| VMAS |  | 5 (5 to 5) |"
    assert lines[-1] == "A, 2 cores; load 1.0 before the run and 2.0 after it; vmas 1.0."
