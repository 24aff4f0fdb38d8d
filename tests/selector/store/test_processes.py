"""Many processes at once lose no update, and one that is killed loses none that was committed."""

import os
import subprocess
import sys

import pytest

from tests.paths import ROOT
from tests.selector.store import killing


@pytest.mark.parametrize(
    ("kills", "processes", "updates"), [(6, 3, 10), pytest.param(200, 8, 100, marks=pytest.mark.long)]
)
def test_processes_at_once_and_kills_lose_no_committed_update(kills, processes, updates):
    command = [sys.executable, "-m", killing.__name__, *map(str, (kills, processes, updates))]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == f"0 of {processes} processes lost updates\ntried {kills}, survived {kills}\n"
