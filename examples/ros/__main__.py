"""`python -m examples.ros robot|world|swarm MISSION`: robots as nodes of ROS 2, on this machine unless told else."""

import argparse
import os
import sys

from examples.robots.command_words import number, words_of
from examples.ros.wire import stay_on_this_machine
from selector.documents.errors import DocumentError

DOMAINS = 232
"""The highest number of a domain of ROS 2, whose ports there are."""


def parser() -> argparse.ArgumentParser:
    """Return what reads the command."""
    words = words_of("python -m examples.ros", str(__doc__))
    above, most = 1e-6, 1e6
    words.add_argument("command", choices=("robot", "world", "swarm"))
    words.add_argument("mission", help="a mission's name or file")
    words.add_argument("--name", default="robot_0", help="of the robot: robot_N")
    words.add_argument("--robots", type=number(0, 1000, int), default=0, help="how many; 0: those of the mission")
    words.add_argument("--time-limit", type=number(0.0, most), default=0.0, help="of the mission [s]; 0: its own")
    words.add_argument("--strategy", default="", help="what chooses options, as in evaluate; else an advised one")
    words.add_argument("--goal", default="", help="what it chooses them for, if it is not made for one")
    words.add_argument("--seed", type=number(0, 2**31, int), default=1, help="of the mission and its start")
    words.add_argument("--scale", type=number(above, most), default=1.0, help="length on the floor of a unit [m]")
    words.add_argument("--twist", action="store_true", help="command by Twist in place of TwistStamped")
    words.add_argument("--rate", type=number(0.1, 1000.0), default=50.0, help="steps of a robot [1/s]")
    words.add_argument("--timeout", type=number(above, most), default=1.0, help="age of a pose at which it stops [s]")
    words.add_argument("--lock-step", action="store_true", help="wait for everybody in each control period")
    words.add_argument("--epoch", type=number(0.0, 1e10), default=0.0, help="when it began, as time() says [s]; 0: now")
    words.add_argument("--speed", type=number(0.01, 100.0), default=1.0, help="seconds of the mission in a second")
    words.add_argument("--loss", type=number(0.0, 1.0), default=0.0, help="share of broadcasts that a robot misses")
    words.add_argument("--twice", type=number(0.0, 1.0), default=0.0, help="share of the others that it hears twice")
    words.add_argument("--delay", type=number(0.0, 60.0), default=0.0, help="until it hears them [s]")
    words.add_argument("--course", default="", help="file of the poses after each control period, for numpy.load")
    words.add_argument("--record", default="", help="folder of the world's recording, for clean-swarm replay")
    words.add_argument("--network", action="store_true", help="find nodes on other machines, too")
    return words


def main() -> int:
    """Read the command and run it."""
    given = parser().parse_args()
    stay_on_this_machine(given.network)
    try:
        number(0, DOMAINS, int)(os.environ.get("ROS_DOMAIN_ID") or "0")
    except argparse.ArgumentTypeError as wrong:
        return failed(f"ROS_DOMAIN_ID: {wrong}")
    try:
        from examples.ros import nodes  # waits, so that help is quick
    except ImportError as missing:
        return failed(f"{missing}: expected ROS 2 (examples/ros/requirements.txt) and the extra `robots`")
    try:
        return {"robot": nodes.run_robot, "world": nodes.run_world, "swarm": nodes.run_swarm}[given.command](given)
    except (DocumentError, OSError) as wrong:
        return failed(str(wrong))
    except KeyboardInterrupt:
        return failed("stopped before the mission began")


def failed(why: str) -> int:
    """Say in one line why nothing could be done; return the exit code."""
    print(f"examples.ros: {why}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
