"""Robots as nodes of ROS 2: the bits of one process in lock step, and what happens when nodes are killed or unheard."""

import json
import os
import signal
import subprocess
import sys
import time
from importlib.util import find_spec
from shutil import which

import numpy as np
import pytest

from tests.clean_swarm_env.robots.lock_step import Both
from tests.paths import ROOT

pytestmark = [pytest.mark.long, pytest.mark.extra]
MISSING = [name for name in ("rclpy", "nav_msgs", "rosbags") if find_spec(name) is None]
if MISSING:
    pytest.skip(f"needs {', '.join(MISSING)}: examples/ros/requirements.txt", allow_module_level=True)
PATHS = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
ENVIRONMENT = os.environ | {"PYTHONPATH": PATHS, "OMP_NUM_THREADS": "1", "ROS_DOMAIN_ID": str(os.getpid() % 100)}


def start(*words):
    """Start a command of the nodes."""
    command = [sys.executable, "-m", "examples.ros", *map(str, words)]
    return subprocess.Popen(command, cwd=ROOT, env=ENVIRONMENT, stdout=subprocess.PIPE, text=True)


class Swarm:
    """A world and robots as processes, which end with the test."""

    def __init__(self, robots, *words):
        self.words = [*words, f"--epoch={time.time()}"]
        self.robots = [self.robot(number) for number in range(robots)]
        self.world = start("world", *self.words)

    def robot(self, number):
        return start("robot", *self.words, "--name", f"robot_{number}")

    def result(self, patience=300):
        return json.loads(self.world.communicate(timeout=patience)[0].splitlines()[-1])

    def wait_until_it_runs(self):
        assert self.world.stdout.readline().startswith("world: all")

    def said(self, number, patience=60):
        return json.loads(self.robots[number].communicate(timeout=patience)[0].splitlines()[-1])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in (*self.robots, self.world):
            process.kill()
            process.communicate()


@pytest.mark.parametrize(
    ("mission", "robots", "seconds", "strategy"),
    [("table1", 5, 60.0, "MaxScore"), ("exploring", 8, 15.0, "fsm:recent-finds")],
)
def test_lock_step_over_ros_has_the_course_of_one_process_tick_by_tick(mission, robots, seconds, strategy, tmp_path):
    both = Both({"base": mission, "time_limit": seconds}, strategy, 1)
    words = mission, "--time-limit", seconds, "--strategy", strategy, "--lock-step", "--course", tmp_path / "course.npy"
    with Swarm(robots, *words) as swarm:
        assert swarm.result()["ticks"] == len(both.course)
    np.testing.assert_array_equal(np.load(tmp_path / "course.npy"), both.course)


def test_a_swarm_without_a_network_has_the_course_of_one_process_tick_by_tick(tmp_path):
    both, course = Both({"base": "table1", "time_limit": 20.0}, "MaxScore", 1), tmp_path / "course.npy"
    alone = ["unshare", "--net", "--uts", "--map-root-user"]
    if not which("unshare") or subprocess.run([*alone, "ip", "link", "set", "lo", "up"], check=False).returncode:
        pytest.skip("needs unshare and ip, and a system that lets users have namespaces")
    words = f"table1 --strategy MaxScore --time-limit 20 --lock-step --course {course}"
    swarm = f"{sys.executable} -m examples.ros swarm {words}"
    whole = [*alone, "sh", "-c", f"ip link set lo up && hostname alone && {swarm}"]
    said = subprocess.run(whole, cwd=ROOT, env=ENVIRONMENT, capture_output=True, text=True, timeout=1800, check=False)
    assert said.returncode == 0, said.stderr
    assert "| ticks | 100 |" in said.stdout
    np.testing.assert_array_equal(np.load(course), both.course)


def test_the_launch_file_starts_all_robots():
    pytest.importorskip("launch", reason="needs launch: that of ROS 2, or github.com/ros2/launch as it is")
    world = start("world", "table1", "--time-limit", 20)
    run = "from launch import *; from launch.actions import *; s = LaunchService(); s.include_launch_description("
    run += "LaunchDescription([IncludeLaunchDescription('examples/ros/robots.launch.py', launch_arguments="
    run += "[('mission', 'table1'), ('scale', '1.0'), ('strategy', 'MaxScore')])])); raise SystemExit(s.run())"
    launched = subprocess.Popen(
        [sys.executable, "-c", run], cwd=ROOT, env=ENVIRONMENT, stdout=subprocess.PIPE, text=True
    )
    try:
        assert json.loads(world.communicate(timeout=300)[0].splitlines()[-1])["ticks"] == 100
        said = launched.communicate(timeout=60)[0]
    finally:
        world.kill()
        launched.send_signal(signal.SIGINT)
    periods = [json.loads(line[line.index("{") :])["periods"] for line in said.splitlines() if '{"name"' in line]
    assert len(periods) == 5
    assert min(periods) > 70


def test_five_robots_keep_the_time_of_the_clock():
    with Swarm(5, "table1", "--time-limit", 30) as swarm:
        found = swarm.result()
        said = [swarm.said(number) for number in range(5)]
    assert found["ticks"] == 150
    print("late", found["late"], "missed", [one["missed"] for one in said])  # the share is of this machine
    assert found["late"] <= 0.25 * 5 * 150
    assert all(one["periods"] > 100 for one in said)


def test_a_robot_that_is_killed_stands_the_others_finish_and_another_one_joins_in_its_place(tmp_path):
    words = "table1", "--time-limit", 60, "--robots", 3, "--course", tmp_path / "course.npy"
    with Swarm(3, *words) as swarm:
        swarm.wait_until_it_runs()
        time.sleep(8.0)
        swarm.robots[2].send_signal(signal.SIGKILL)
        time.sleep(8.0)
        swarm.robots.append(swarm.robot(2))
        assert swarm.result()["ticks"] == 300
        assert all(swarm.said(number)["periods"] > 100 for number in (0, 1))
        assert swarm.said(3)["periods"] > 10
    moved = np.abs(np.diff(np.load(tmp_path / "course.npy")[:, 2, :2], axis=0)).max(axis=1) > 1e-6
    stood = next(tick for tick in range(len(moved)) if tick > 50 and not moved[tick : tick + 20].any())
    assert moved[stood + 20 :].any()


def test_robots_whose_world_is_killed_stand_and_end():
    with Swarm(2, "table1", "--time-limit", 300, "--robots", 2) as swarm:
        swarm.wait_until_it_runs()
        time.sleep(6.0)
        swarm.world.send_signal(signal.SIGKILL)
        for number in range(2):
            assert swarm.said(number, patience=30)["periods"] > 10
            assert swarm.robots[number].returncode == 0


def test_robots_that_hear_badly_go_on():
    words = "table1", "--time-limit", 30, "--robots", 3, "--loss", 0.3, "--delay", 0.4, "--twice", 0.2
    with Swarm(3, *words) as swarm:
        assert swarm.result()["ticks"] == 150
        for number in range(3):
            said = swarm.said(number)
            assert said["periods"] > 100
            assert said["old"] > 5  # those that came twice
            assert said["damaged"] == 0
