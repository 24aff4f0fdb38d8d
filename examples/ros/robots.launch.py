"""Start the robots of a laboratory together: `ros2 launch examples/ros/robots.launch.py`, in this repository."""

import sys
import time

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration

GIVEN = {"mission": "lab-epuck2", "scale": "0.14", "strategy": "", "seed": "1"}
ROBOTS = 5


def generate_launch_description() -> LaunchDescription:
    """Return one node for each robot; all have the same mission, seed and epoch."""
    given = {name: LaunchConfiguration(name) for name in GIVEN}
    words = [given["mission"], *(word for name in ("scale", "strategy", "seed") for word in (f"--{name}", given[name]))]
    command = [sys.executable, "-m", "examples.ros", "robot", *words, f"--epoch={time.time()}"]
    return LaunchDescription(
        [
            *(DeclareLaunchArgument(name, default_value=value) for name, value in GIVEN.items()),
            *(ExecuteProcess(cmd=[*command, "--name", f"robot_{k}"], output="screen") for k in range(ROBOTS)),
        ]
    )
