"""Tests that interrupt commands pass where the suite was started with Ctrl-C and hangups ignored."""

import subprocess
import sys

import pytest

from tests.paths import ROOT

CHILD = "import signal; print(signal.getsignal(2) is signal.default_int_handler, signal.getsignal(1) == signal.SIG_DFL)"


def test_a_child_hears_ctrl_c_and_hangups():
    assert subprocess.check_output([sys.executable, "-c", CHILD], text=True) == "True True\n"


@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell")
def test_children_hear_them_where_the_suite_was_started_without():
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", __file__, "-k", "child_hears"]
    shell = ["sh", "-c", 'trap "" INT HUP; exec "$@"', "sh", *command]
    done = subprocess.run(shell, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
