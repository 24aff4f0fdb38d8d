"""`python -m examples.ros robot|world|swarm MISSION`: robots as nodes of ROS 2, on this machine unless told else."""

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor

from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.given import mission_from
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import Sensed
from examples.robots.bad_reception import Faults
from examples.robots.bodies import ServedBodies
from examples.ros.robot import LockStep, RobotNode
from examples.ros.wire import MissionClock, stay_on_this_machine
from examples.ros.world import WorldNode

PATIENCE = 5.0
"""Time without a pose after which a robot's node ends, and before the first one of a mission [s of the clock]."""
WAIT = 180.0
"""Time in which all nodes have to be there [s]."""


def mission_of(given: argparse.Namespace) -> object:
    """Return the mission, with another number of robots and another time limit if these are given."""
    changes = {"robots": {"count": given.robots}} if given.robots else {}
    changes |= {"time_limit": given.time_limit} if given.time_limit else {}
    return mission_from({"base": given.mission, **changes} if changes else given.mission)


def run_robot(given: argparse.Namespace) -> int:
    """Run the node of one robot until the bodies are gone."""
    mission, clock = mission_of(given), MissionClock(given.epoch, given.speed)
    number = int(given.name.rpartition("_")[2])
    start = random_start(mission, given.seed, 0)
    timeout = given.timeout * given.speed
    warm_up(RobotProcess(mission, number, given.strategy, start=start))
    robot = RobotProcess(mission, number, given.strategy, start=start, seed=given.seed, timeout=timeout)
    executor = SingleThreadedExecutor()
    faults = Faults(given.loss, given.delay, given.twice)
    radius = given.scale * robot.mission.robots.radius
    node = RobotNode(robot, clock, stamped=not given.twist, radius=radius, scale=given.scale, faults=faults)
    executor.add_node(node)
    if given.lock_step:
        LockStep(node, lambda: executor.spin_once(0.05)).run()
    else:
        follow(node, executor, given.rate)
    print(json.dumps({"name": robot.name, **node.summary}), flush=True)
    return 0


def warm_up(robot: RobotProcess) -> None:
    """Load the compiled code of a robot that is not used: the first steps of a process take seconds."""
    for tick in range(12):
        now = 0.2 * tick
        robot.sense(Sensed(stamp=now, x=1.0, y=1.0, heading=0.0))
        robot.say(now)
        robot.step(now)


def follow(node: RobotNode, executor: SingleThreadedExecutor, rate: float) -> None:
    """Step a robot `rate` times a second until no pose has come for PATIENCE; the wheels stand long before that."""
    due, patience = time.monotonic(), PATIENCE * node.clock.speed
    while node.link_age < (patience if node.ticks else WAIT * node.clock.speed):
        executor.spin_once(0.0)  # also where a step took longer than its time
        while time.monotonic() < due:
            executor.spin_once(max(due - time.monotonic(), 0.0))
        due = max(due + 1.0 / rate, time.monotonic())
        if node.link_age < patience:
            node.run_once()


def run_world(given: argparse.Namespace) -> int:
    """Run the bodies of a mission, and print its figures."""
    mission, clock = mission_of(given), MissionClock(given.epoch, given.speed)
    record = RecordSettings(Path(given.record), name="swarm") if given.record else None
    bodies = ServedBodies(mission, random_start(mission, given.seed, 0), given.seed, record=record)
    executor, node = SingleThreadedExecutor(), WorldNode(bodies, clock, given.scale)
    executor.add_node(node)
    until = time.monotonic() + WAIT
    while not node.all_there():
        executor.spin_once(0.05)
        if time.monotonic() > until:
            print(f"world: expected {len(node.names)} robots within {WAIT:g} s, got {node.someone_there()}")
            return 1
    print(f"world: all {len(node.names)} robots are there", flush=True)
    if given.lock_step:
        node.run_in_step(lambda: executor.spin_once(0.05))
        executor.spin_once(0.5)
    else:
        keep_time(node, executor)
    if given.course:
        np.save(given.course, np.array(node.course))
    print(json.dumps({"ticks": node.ticks, "late": node.late, "result": bodies.result.as_mapping()}), flush=True)
    return 0


def keep_time(node: WorldNode, executor: SingleThreadedExecutor) -> None:
    """Run control periods at the speed of the clock."""
    period = node.bodies.worlds.period / node.clock.speed
    node.show(node.bodies.sense())
    due = time.monotonic() + period
    while node.bodies.running and rclpy.ok():
        while time.monotonic() < due:
            executor.spin_once(max(due - time.monotonic(), 0.0))
        due += period
        node.run_period()


def run_swarm(given: argparse.Namespace) -> int:
    """Start all robots and the world, and print the figures of the mission as `evaluate` has them."""
    words = [word for word in sys.argv[2:] if not word.startswith("--epoch")]
    names = [f"robot_{row}" for row in range(mission_of(given).rows)]
    own = [sys.executable, "-m", "examples.ros"]
    epoch = [f"--epoch={time.time()}"]
    robots = [
        subprocess.Popen([*own, "robot", *words, *epoch, "--name", name], stdout=subprocess.PIPE) for name in names
    ]
    try:
        world = subprocess.run([*own, "world", *words, *epoch], stdout=subprocess.PIPE, check=True, text=True)
        said = [json.loads(robot.communicate(timeout=WAIT)[0]) for robot in robots]
    finally:
        for robot in robots:
            robot.kill()
    found = json.loads(world.stdout.splitlines()[-1])
    print(table({**found["result"], "late_share": found["late"] / max(found["ticks"] * len(names), 1)}))
    for one in said:
        print(json.dumps(one))
    return 0


def table(figures: dict) -> str:
    """Return figures as a table."""
    shown = {key: value for key, value in figures.items() if not isinstance(value, dict | list | tuple)}
    rows = [f"| {key} | {round(value, 6) if isinstance(value, float) else value} |" for key, value in shown.items()]
    return "\n".join(["| figure | value |", "|---|---|", *rows])


def main() -> int:
    """Read the command and run it."""
    parser = argparse.ArgumentParser(prog="python -m examples.ros", description=__doc__)
    parser.add_argument("command", choices=("robot", "world", "swarm"))
    parser.add_argument("mission", help="a mission's name or file")
    parser.add_argument("--name", default="robot_0", help="of the robot: robot_N")
    parser.add_argument("--robots", type=int, default=0, help="how many, in place of those of the mission")
    parser.add_argument("--time-limit", type=float, default=0.0, help="of the mission [s], in place of its own")
    parser.add_argument("--strategy", default="MaxScore", help="what chooses options, as in evaluate")
    parser.add_argument("--seed", type=int, default=1, help="of the mission and its start")
    parser.add_argument("--scale", type=float, default=1.0, help="length on the floor of a unit of the mission [m]")
    parser.add_argument("--twist", action="store_true", help="command by Twist in place of TwistStamped")
    parser.add_argument("--rate", type=float, default=50.0, help="steps of a robot [1/s]")
    parser.add_argument("--timeout", type=float, default=1.0, help="age of a pose at which wheels stop [s]")
    parser.add_argument("--lock-step", action="store_true", help="wait for everybody in each control period")
    parser.add_argument("--epoch", type=float, default=0.0, help="when the mission began, as time() says [s]")
    parser.add_argument("--speed", type=float, default=1.0, help="seconds of the mission in a second")
    parser.add_argument("--loss", type=float, default=0.0, help="share of broadcasts that a robot does not hear")
    parser.add_argument("--twice", type=float, default=0.0, help="share that it hears twice")
    parser.add_argument("--delay", type=float, default=0.0, help="until it hears them [s]")
    parser.add_argument("--course", default="", help="file of the poses after each control period, for numpy.load")
    parser.add_argument("--record", default="", help="folder of the world's recording, for clean-swarm replay")
    parser.add_argument("--network", action="store_true", help="find nodes on other machines, too")
    given = parser.parse_args()
    stay_on_this_machine(given.network)
    if given.command == "swarm":
        return run_swarm(given)
    rclpy.init(args=[])
    try:
        return {"robot": run_robot, "world": run_world}[given.command](given)
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    sys.exit(main())
