"""Missions over a bad radio: what is wrong in a command is one line, and Ctrl-C keeps what is done."""

import os
import re
import signal
import subprocess
import sys

import numpy as np
import pytest

from clean_swarm_env.robots.sensed import Broadcast
from examples.robots import bad_radio
from examples.robots.bad_reception import BadReception, Faults
from tests.clean_swarm_env.robots.commands import ended
from tests.paths import ROOT

COMMAND = "table1", "MaxScore", "1"


def said_by(words, capsys, monkeypatch):
    """Return the exit code of a command, and what it says."""
    return ended(bad_radio.main, ["bad_radio", *words], capsys, monkeypatch)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((), "the following arguments are required: mission, strategy, starts"),
        (("table1", "MaxScore", "0"), "starts: expected a whole number from 1 to 10000, got '0'"),
        (("table1", "MaxScore", "nan"), "starts: expected a whole number from 1 to 10000, got 'nan'"),
        (("table1", "MaxScore", "1e99"), "starts: expected a whole number from 1 to 10000, got '1e99'"),
        ((*COMMAND, "--loss", "1.5"), "--loss: expected a number from 0 to 0.99, got '1.5'"),
        ((*COMMAND, "--delay", "inf"), "--delay: expected a number from 0 to 60, got 'inf'"),
        ((*COMMAND, "--twice", "-0.1"), "--twice: expected a number from 0 to 1, got '-0.1'"),
        (("nowhere", "MaxScore", "1"), "bad_radio: unknown mission or task 'nowhere'"),
        (("table1", "fixed:Nothing", "1"), "unknown option 'Nothing'"),
        (("table1", "fsm:nothing", "1"), "unknown machine 'nothing'"),
        (("scouts", "MaxScore", "1"), "expected robots that carry items"),
    ],
)
def test_wrong_words_are_one_line(words, says, capsys, monkeypatch):
    code, said = said_by(words, capsys, monkeypatch)
    assert code == 2
    assert says in said.err
    assert said.err.count("\n") == 1
    assert not said.out


def test_a_start_has_means_without_intervals(capsys, monkeypatch, tmp_path):
    (tmp_path / "short.yaml").write_text("{name: short, world: {width: 12.0, height: 12.0}, time_limit: 6.0}")
    code, said = said_by((str(tmp_path / "short.yaml"), "MaxScore", "1", "--loss", "0"), capsys, monkeypatch)
    assert (code, said.err) == (0, "1 of 1 starts\n")
    assert re.search(r"^by processes: [\d.]+ s\nin one process: ", said.out)


def test_a_reception_loses_its_share_and_keeps_the_order():
    ear = BadReception(Faults(loss=0.3, delay=0.4, twice=0.2), np.random.default_rng(1))
    for number in range(1_000):
        ear.send(Broadcast("robot_1", number, 0.0), now=0.0)
    first = [said.sequence for said in ear.heard(0.5)]
    again = [said.sequence for said in ear.heard(0.7)]
    assert first == sorted(first)
    assert 650 < len(first) < 750
    assert {*again} < {*first}
    assert 100 < len(again) < 180
    assert ear.heard(9.0) == []


@pytest.mark.long
def test_after_ctrl_c_the_means_of_what_is_done_are_there():
    command = [sys.executable, "-u", "-m", "examples.robots.bad_radio", "exploring", "fsm:recent-finds", "10000"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=ROOT, env=os.environ | {"PYTHONPATH": str(ROOT)}, **pipes) as running:
        assert running.stderr.readline().startswith("1 of 10000 starts")
        running.send_signal(signal.SIGINT)
        out, err = running.communicate(timeout=120)
    assert running.returncode == 0
    assert err.splitlines()[-1].startswith("stopped after ")
    assert "by processes: " in out
