"""Mechanisms and networks have the same bits under each switch of the compiler, in a process of its own.

Without a compiler this takes a second; else all kernels are compiled anew, and a small one stands for them in
compiler/test_records.py.
"""

import json
import os
import subprocess
import sys

import pytest

from selforg.mechanisms import MECHANISMS
from tests.paths import ROOT
from tests.selforg.scenario import digests

OURS = [name for name in MECHANISMS.names() if MECHANISMS.find(name).__module__.startswith("selforg.")]
SOME = ("RepulsionFernandez", "ChemotaxisGe", "FollowAll", "FollowStrongest", "Exploitation", "FlockingReynolds",
        "Flocking", "Patrol", "DepositPheromonesMin", "GossipMax", "ORCA")  # fmt: skip
"""One mechanism of each kind, where all kernels are compiled anew."""


@pytest.mark.parametrize(
    ("switch", "names"),
    [
        ("NUMBA_DISABLE_JIT", OURS),
        pytest.param("CLEAN_SWARM_PLAIN_NUMBA", SOME, marks=pytest.mark.long),
        pytest.param("CLEAN_SWARM_CHECK_RECORDS", SOME, marks=pytest.mark.long),
    ],
)
def test_a_switch_changes_no_bit(switch, names):
    command = [sys.executable, "-m", "tests.selforg.scenario", *names]
    done = subprocess.run(command, cwd=ROOT, env={**os.environ, switch: "1"}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == digests(names)
