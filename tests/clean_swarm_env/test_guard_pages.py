"""Between guard pages copies access nothing of their originals and nothing outside of arrays; planted faults end it."""

import signal
import subprocess
import sys

import pytest

from selforg.compiler.switches import COMPILED
from tests.paths import ROOT

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs Linux's mmap"),
    pytest.mark.skipif(not COMPILED, reason="arrays of plain Python check their bounds"),
]


def run(count, fault):
    command = [sys.executable, "-m", "tests.clean_swarm_env.guarded_copies", str(count), fault]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600)


def test_copies_of_random_missions_and_goals_access_nothing_outside():
    done = run(6, "none")
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[0] == "6 copies between guard pages: equal bits, no access outside"


@pytest.mark.parametrize("fault", ["address", "behind"])
def test_planted_faults_end_the_process(fault):
    done = run(1, fault)
    assert done.returncode == -signal.SIGSEGV, done.stderr
    assert "Segmentation fault" in done.stderr
