"""Commands of the nodes of ROS 2: what is wrong is one line, before anything drives; text of others crashes nothing."""

import json
from importlib.util import find_spec

import pytest

from clean_swarm_env.robots.sensed import SeenItem, Sensed
from examples.ros import __main__ as command
from examples.ros.wire import as_text, from_text, sensed_in
from tests.clean_swarm_env.robots.commands import ended


def said_by(words, capsys, monkeypatch):
    """Return the exit code of a command, and what it says."""
    return ended(command.main, ["examples.ros", *words], capsys, monkeypatch)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((), "the following arguments are required: command, mission"),
        (("fly", "table1"), "argument command: invalid choice: 'fly'"),
        (("robot", "table1", "--rate", "0"), "--rate: expected a number from 0.1 to 1000, got '0'"),
        (("robot", "table1", "--rate", "1e9"), "--rate: expected a number from 0.1 to 1000, got '1e9'"),
        (("world", "table1", "--speed", "nan"), "--speed: expected a number from 0.01 to 100, got 'nan'"),
        (("swarm", "table1", "--robots", "-1"), "--robots: expected a whole number from 0 to 1000, got '-1'"),
        (("robot", "table1", "--scale", "0"), "--scale: expected a number from 1e-06 to 1e+06, got '0'"),
    ],
)
def test_wrong_words_are_one_line(words, says, capsys, monkeypatch):
    code, said = said_by(words, capsys, monkeypatch)
    assert code == 2
    assert says in said.err
    assert said.err.count("\n") == 1


@pytest.mark.parametrize("domain", ["300", "-1", "hall"])
def test_a_wrong_domain_is_one_line(domain, capsys, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    code, said = said_by(("robot", "table1"), capsys, monkeypatch)
    expected = f"examples.ros: ROS_DOMAIN_ID: expected a whole number from 0 to 232, got {domain!r}\n"
    assert (code, said.err) == (2, expected)


@pytest.mark.skipif(find_spec("rclpy") is not None, reason="ROS 2 is here")
def test_without_ros_one_line_says_where_it_comes_from(capsys, monkeypatch):
    code, said = said_by(("swarm", "table1"), capsys, monkeypatch)
    assert code == 2
    assert "No module named 'rclpy': expected ROS 2 (examples/ros/requirements.txt)" in said.err
    assert said.err.count("\n") == 1


@pytest.mark.extra
@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("robot", "nowhere"), "unknown mission or task 'nowhere'"),
        (("robot", "table1", "--name", "an odd name"), "--name: expected robot_0 to robot_4, got 'an odd name'"),
        (("robot", "table1", "--name", "robot_5"), "--name: expected robot_0 to robot_4, got 'robot_5'"),
        (("swarm", "table1", "--strategy", "fixed:Nothing"), "unknown option 'Nothing'"),
        (("swarm", "table1", "--course", "/nowhere/x.npy"), "No such file or directory: '/nowhere/x.npy'"),
        (("world", "scouts", "--record", "/proc/x"), "/proc/x"),
    ],
)
def test_what_cannot_be_done_is_one_line(words, says, capsys, monkeypatch):
    pytest.importorskip("rclpy", reason="needs rclpy: examples/ros/requirements.txt")
    code, said = said_by(words, capsys, monkeypatch)
    assert code == 2
    assert says in said.err
    assert said.err.count("\n") == 1


def test_what_is_sensed_keeps_its_bits_as_text_and_may_be_a_part():
    whole = Sensed(0.1, 2.0, 1 / 3, 0.5, 1, ((1.0, 2.0),), {3: SeenItem(0.1, 0.2, True)}, (4, 5), True)
    assert from_text(as_text(whole)) == whole
    assert sensed_in(json.dumps({"items": {"7": [1.0, 2.0]}})) == {"items": {7: SeenItem(1.0, 2.0)}}
