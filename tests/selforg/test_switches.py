"""Gradients and mechanisms give the same numbers under each switch of the compiler, in a process of its own."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from tests.paths import ROOT
from tests.selforg.scenario import play


@pytest.mark.parametrize("switch", ["CLEAN_SWARM_PLAIN_NUMBA", "CLEAN_SWARM_CHECK_RECORDS", "NUMBA_DISABLE_JIT"])
def test_a_switch_changes_no_number(switch):
    command = [sys.executable, "-m", "tests.selforg.scenario"]
    environment = {**os.environ, switch: "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    np.testing.assert_array_equal(json.loads(done.stdout), play())
