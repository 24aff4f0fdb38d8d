"""Many processes at once lose no update, and one that is killed loses none that was committed."""

import os
import subprocess
import sys

import pytest

from tests.paths import ROOT
from tests.selector.store import hammer, killing


def run(module: str, *words: object) -> str:
    """Run a program of this directory and return what it prints; it ends with an error if something is wrong."""
    done = subprocess.run(
        [sys.executable, "-m", module, *map(str, words)],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_8_processes_make_500_updates_each_and_all_count(new_url):
    assert run(hammer.__name__, new_url(), 8, 500).startswith("4000 of 4000 updates counted, exact: True, 0 failed")


def test_200_kills_leave_every_committed_update(tmp_path):
    said = run(killing.__name__, f"{tmp_path}/{{}}.sqlite", 200)
    assert said.startswith("200 kills")
    assert " 0 mistakes" in said


@pytest.mark.parametrize("kills", [20])
def test_killed_clients_of_postgres_leave_every_committed_update(postgres, kills):
    assert " 0 mistakes" in run(killing.__name__, postgres, kills)
