"""Ctrl-C twice, at any moment: exit code 130, one line, and nothing left behind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.paths import ROOT
from tests.train.commands import start, wait_for_end, wait_for_runs
from tests.train.waiting import until

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")


def interrupt_twice(process, gap):
    """Send Ctrl-C twice, `gap` [s] apart, as a terminal does; return what the command wrote on the standard error."""
    os.killpg(process.pid, signal.SIGINT)
    time.sleep(gap)
    os.killpg(process.pid, signal.SIGINT)  # the process is not yet waited for, so its group is there
    return process.communicate(timeout=120)[1]


def handles_sigterm(process):
    lines = Path(f"/proc/{process.pid}/status").read_text().splitlines()
    caught = next(line for line in lines if line.startswith("SigCgt"))
    return bool(int(caught.split()[1], 16) >> signal.SIGTERM - 1 & 1)


def run_code(code):
    return subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=300)


@pytest.mark.long
@pytest.mark.parametrize("workers", ["1", "2"])
@pytest.mark.parametrize("gap", [0.0, 0.02, 0.3])
def test_ctrl_c_twice_in_the_runs_leaves_nothing_behind(tmp_path, workers, gap):
    words = ("--scenarios", "20", "--output", "r", "--workers", workers)
    process = start(tmp_path, *words, seconds="0.3")
    wait_for_runs(process, tmp_path / "r", 2)
    err = interrupt_twice(process, gap)
    assert process.returncode == 130
    assert err.count("interrupted") == 1
    assert "Traceback" not in err
    wait_for_end(process.pid)
    assert not list((tmp_path / "r").glob(".*"))


@pytest.mark.long
@pytest.mark.parametrize("wait", [0.0, 0.3, 1.0])
def test_ctrl_c_twice_during_the_imports_is_one_line(tmp_path, wait):
    command = [sys.executable, "-m", "clean_swarm_env", "evaluate", "--output", "r"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(command, cwd=tmp_path, env=environment, start_new_session=True, **pipes)
    until(lambda: handles_sigterm(process))
    time.sleep(wait)
    err = interrupt_twice(process, 0.02)
    assert process.returncode == 130
    assert err.startswith("interrupted")
    assert "Traceback" not in err


@pytest.mark.parametrize("module", ["importlib._bootstrap", "llvmlite.binding"])
def test_a_signal_waits_until_an_import_or_llvm_is_done(module):
    code = (
        "import os, signal, sys, time\n"
        "from train.cli.interruption import Interruption\n"
        f"space = {{'__name__': '{module}', 'os': os, 'time': time}}\n"
        "exec('def compiles():\\n os.kill(os.getpid(), 2)\\n time.sleep(0.3)\\n print(1, flush=True)', space)\n"
        "with Interruption():\n"
        "    try:\n"
        "        space['compiles']()\n"
        "        time.sleep(60.0)\n"
        "    except KeyboardInterrupt:\n"
        "        print(2)\n"
    )
    done = run_code(code)
    assert done.stdout.split() == ["1", "2"]


@pytest.mark.parametrize("ends", ["os.kill(os.getpid(), 2)", "pass"])
def test_no_signal_that_waited_comes_after_the_end(ends):
    code = (
        "import os, signal\n"
        "from train.cli.interruption import Interruption\n"
        "space = {'__name__': 'llvmlite.binding', 'os': os}\n"
        "exec('def compiles():\\n os.kill(os.getpid(), 2)', space)\n"
        "try:\n"
        "    with Interruption():\n"
        "        space['compiles']()\n"
        "        print(signal.getitimer(signal.ITIMER_REAL)[0] > 0.0)\n"
        f"        {ends}\n"
        "except KeyboardInterrupt:\n"
        "    pass\n"
        "print(signal.getitimer(signal.ITIMER_REAL)[0] > 0.0)\n"
    )
    done = run_code(code)
    assert done.stdout.split() == ["True", "False"]


@pytest.mark.parametrize("place", ["typer.main.get_command", "typer.core.TyperGroup.parse_args"])
def test_ctrl_c_before_a_command_begins_is_one_line(place):
    code = (
        "import sys, typer.core, typer.main\n"
        "from train.cli import app, main\n"
        "def interrupted(*words, **more):\n    raise KeyboardInterrupt\n"
        f"{place} = interrupted\n"
        "sys.argv = ['clean-swarm', 'list']\n"
        "main()\n"
    )
    done = run_code(code)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


def test_a_signal_comes_again_where_its_exception_was_dropped():
    code = (
        "import os, time\n"
        "from train.cli.interruption import Interruption\n"
        "class Dropping:\n"
        "    def __del__(self):\n"
        "        os.kill(os.getpid(), 2)\n"
        "        time.sleep(60.0)\n"
        "with Interruption():\n"
        "    try:\n"
        "        Dropping()\n"
        "        time.sleep(60.0)\n"
        "    except KeyboardInterrupt:\n"
        "        print(1)\n"
    )
    done = run_code(code)
    assert (done.stdout, done.stderr) == ("1\n", "")
