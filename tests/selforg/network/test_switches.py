"""A network decides the same under every switch of the compiler."""

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from tests.paths import ROOT
from tests.selforg.network.cleaning import cleaning_model, wandering

ROWS, STEPS = 4, 12


def digest():
    """A digest of everything that a small network knows in the course of a life."""
    model = cleaning_model()
    network = BehaviourNetwork(model, ROWS, Planner(model), explained=True)
    told = hashlib.sha256()
    for now in wandering(np.random.default_rng(3), STEPS, ROWS):
        network.readings[:] = now
        network.step()
        for array in network.state:
            told.update(np.asarray(array).tobytes())
    return told.hexdigest()


@pytest.mark.parametrize("switch", ["CLEAN_SWARM_PLAIN_NUMBA", "NUMBA_DISABLE_JIT"])
def test_the_same_bits_under_every_switch(switch):
    script = "from tests.selforg.network.test_switches import digest; print(digest())"
    environment = {**os.environ, switch: "1", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == digest()
