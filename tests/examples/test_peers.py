"""The benchmark of peers: our own contestants step, one that fails is one line, and the table has a row for each."""

import sys
from pathlib import Path

import pytest

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
