"""Runs nodes: a robot, our world behind topics, or a whole swarm of processes on this machine."""

import argparse
import json
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from pathlib import Path

import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.given import mission_from
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import Sensed
from clean_swarm_env.world.task import coordinators_of
from examples.robots.bad_reception import Faults
from examples.robots.bodies import ServedBodies
from examples.ros.robot import LockStep, RobotNode
from examples.ros.wire import MissionClock
from examples.ros.world import STANDING, WorldNode
from selector.configurations.library import library_of
from selector.documents.errors import DocumentError

PATIENCE = 5.0
"""Time without a pose after which a robot's node ends, once it has had one [s of the clock]."""
WAIT = 180.0
"""Time in which all nodes have to be there, and before the first pose, once the own code is loaded [s]."""
MEETING = 3.0
"""Time for which a node looks for others of its name [s]."""
BOTH = "AvoidCollision+ExplorationPatrol"
ADVISED = (
    ("fixed:ORCA+Patrol", BOTH, {"ORCA", "Patrol"}),
    ("fixed:RepulsionGradient-view1.5", "", {"RepulsionGradient-view1.5"}),
    ("MaxScore", "", set[str]()),
)
"""Strategies from the best on, their goals, and the options that each needs; docs/robots.md has the reason."""


def mission_of(given: argparse.Namespace) -> MissionConfig:
    """Return the mission, with another number of robots and another time limit if these are given."""
    changes = {"robots": {"count": given.robots}} if given.robots else {}
    changes |= {"time_limit": given.time_limit} if given.time_limit else {}
    return mission_from({"base": given.mission, **changes} if changes else given.mission)


def strategy_of(given: argparse.Namespace, mission: MissionConfig) -> tuple[str, str | None]:
    """Return the strategy and the goal that are given, or the first of those advised whose options the robots have."""
    if given.strategy:
        return given.strategy, given.goal or None
    models = coordinators_of(mission, knowledge_of(mission, ()), library_of(()), ())
    known = {option for model in models for option in model.options}
    strategy, goal = next((strategy, goal) for strategy, goal, options in ADVISED if options <= known)
    return strategy, given.goal or goal or None


def robot_of(given: argparse.Namespace, name: str) -> RobotProcess:
    """Return a robot, once all compiled code that it needs is loaded: the first steps of a process take seconds."""
    mission = mission_of(given)
    start, (strategy, goal) = random_start(mission, given.seed, 0), strategy_of(given, mission)
    names = [f"robot_{row}" for row in range(mission.rows)]
    if name not in names:
        raise DocumentError(f"--name: expected robot_0 to {names[-1]}, got {name!r}")
    settings = {"start": start, "goal": goal, "timeout": given.timeout * given.speed}
    warm_up(RobotProcess(mission, names.index(name), strategy, **settings))
    return RobotProcess(mission, names.index(name), strategy, seed=given.seed, **settings)


def warm_up(robot: RobotProcess) -> None:
    """Run the first steps of a robot that is not used."""
    for tick in range(12):
        now = 0.2 * tick
        robot.sense(Sensed(stamp=now, x=1.0, y=1.0, heading=0.0))
        robot.say(now)
        robot.step(now)


@contextmanager
def ros() -> Iterator[SingleThreadedExecutor]:
    """Run nodes; Ctrl-C and SIGTERM are for the caller, who still can send messages then."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as wrong:
        raise DocumentError(f"ROS 2: {wrong}") from None
    try:
        yield SingleThreadedExecutor()
    finally:
        rclpy.try_shutdown()


def run_robot(given: argparse.Namespace) -> int:
    """Run the node of one robot until the bodies are gone."""
    robot = robot_of(given, given.name)
    with ros() as executor:
        check_alone(executor, [f"/{robot.name}/cmd_vel"])
        clock, faults = MissionClock(given.epoch, given.speed), Faults(given.loss, given.delay, given.twice)
        radius = given.scale * robot.mission.robots.radius
        node = RobotNode(robot, clock, stamped=not given.twist, radius=radius, scale=given.scale, faults=faults)
        executor.add_node(node)
        try:
            if given.lock_step:
                LockStep(node, lambda: executor.spin_once(0.05)).run()
            else:
                follow(node, executor, given.rate)
        except KeyboardInterrupt:
            print(f"{robot.name}: stopped, its wheels stand", file=sys.stderr)
        finally:
            node.stand()
    print(json.dumps({"name": robot.name, **node.summary}), flush=True)
    return 0


def check_alone(executor: SingleThreadedExecutor, topics: list[str]) -> None:
    """Raise DocumentError if a node publishes one of these topics already, for which there has to be one."""
    looking = Node("looking")
    executor.add_node(looking)
    until = time.monotonic() + MEETING
    while time.monotonic() < until:
        executor.spin_once(0.05)
    taken = [topic for topic in topics if looking.count_publishers(topic)]
    executor.remove_node(looking)
    looking.destroy_node()
    if taken:
        raise DocumentError(f"{taken[0]}: expected no other node that publishes it, got one")


def follow(node: RobotNode, executor: SingleThreadedExecutor, rate: float) -> None:
    """Step a robot `rate` times a second until no pose has come for PATIENCE; the wheels stand long before that."""
    due, patience = time.monotonic(), PATIENCE * node.clock.speed
    wait_for_pose(node, executor)
    while node.link_age < patience:
        executor.spin_once(0.0)  # also where a step took longer than its time
        while time.monotonic() < due:
            executor.spin_once(max(due - time.monotonic(), 0.0))
        due = max(due + 1.0 / rate, time.monotonic())
        if node.link_age < patience:
            node.run_once()


def wait_for_pose(node: RobotNode, executor: SingleThreadedExecutor) -> None:
    """Wait for the first pose, and say once a second that there is none."""
    begun = said = time.monotonic()
    while node.link_age == inf:
        executor.spin_once(0.02)
        now = time.monotonic()
        if now > said + 1.0:
            said = now
            node.diagnose(STANDING._replace(stopped="pose"))
        if now > begun + WAIT:
            raise DocumentError(f"/{node.robot.name}/odom: expected a pose within {WAIT:g} s, got none")


def run_world(given: argparse.Namespace) -> int:
    """Run the bodies of a mission, and print its figures; after Ctrl-C those so far."""
    bodies = bodies_of(given)
    with ros() as executor:
        check_alone(executor, [f"/robot_{row}/odom" for row in range(bodies.worlds.rows)])
        node = WorldNode(bodies, MissionClock(given.epoch, given.speed), given.scale)
        executor.add_node(node)
        try:
            wait_for_all(node, executor)
            print(f"world: all {len(node.names)} robots are there", flush=True)
            if given.lock_step:
                node.run_in_step(lambda: executor.spin_once(0.05))
            else:
                keep_time(node, executor)
        except KeyboardInterrupt:
            print(f"world: stopped after {node.ticks} control periods, so not completed", file=sys.stderr)
        finally:
            bodies.close()
    if given.course:
        with Path(given.course).open("wb") as file:
            np.save(file, np.array(node.course))
    print(json.dumps({"ticks": node.ticks, "late": node.late, "result": bodies.result.as_mapping()}), flush=True)
    return 0


def bodies_of(given: argparse.Namespace) -> ServedBodies:
    """Return the bodies of a mission; DocumentError if what they did could not be written."""
    if given.course:
        Path(given.course).open("ab").close()
    mission = mission_of(given)
    record = RecordSettings(Path(given.record), name="swarm") if given.record else None
    return ServedBodies(mission, random_start(mission, given.seed, 0), given.seed, record=record)


def wait_for_all(node: WorldNode, executor: SingleThreadedExecutor) -> None:
    """Wait until all robots are there."""
    until = time.monotonic() + WAIT
    while not node.all_there():
        executor.spin_once(0.05)
        if time.monotonic() > until:
            there = f"got {node.someone_there()}: do they have this ROS_DOMAIN_ID?"
            raise DocumentError(f"world: expected {len(node.names)} robots within {WAIT:g} s, {there}")


def keep_time(node: WorldNode, executor: SingleThreadedExecutor) -> None:
    """Run control periods at the speed of the clock."""
    period = node.bodies.worlds.period / node.clock.speed
    node.show(node.bodies.sense())
    due = time.monotonic() + period
    while node.bodies.running:
        while time.monotonic() < due:
            executor.spin_once(max(due - time.monotonic(), 0.0))
        due += period
        node.run_period()


def run_swarm(given: argparse.Namespace) -> int:
    """Start all robots and the world, and print the figures of the mission as `evaluate` has them.

    What is given is checked here first, and code that has to be compiled is compiled once.
    """
    robot_of(given, "robot_0")
    bodies_of(argparse.Namespace(**{**vars(given), "record": ""}))
    names = [f"robot_{row}" for row in range(mission_of(given).rows)]
    own, words = [sys.executable, "-m", "examples.ros"], [*sys.argv[2:], f"--epoch={time.time()}"]
    apart = {"stdout": subprocess.PIPE, "text": True, "start_new_session": True}  # Ctrl-C is for the swarm
    robots = {name: subprocess.Popen([*own, "robot", *words, f"--name={name}"], **apart) for name in names}
    world = subprocess.Popen([*own, "world", *words], **apart)
    try:
        wait_for_world(world, robots)
        ended = [robot.communicate(timeout=WAIT)[0].splitlines() for robot in robots.values()]
    except KeyboardInterrupt:
        ended = []
    finally:
        for process in (world, *robots.values()):
            process.terminate()
    lines = world.communicate()[0].splitlines()
    if not lines or not lines[-1].startswith("{"):
        return 1  # it has said why
    found = json.loads(lines[-1])
    print(table({**found["result"], "late_share": found["late"] / max(found["ticks"] * len(names), 1)}))
    for said in ended:
        print(*said[-1:])
    return 0


def wait_for_world(world: subprocess.Popen, robots: dict[str, subprocess.Popen]) -> None:
    """Wait until the mission is over; DocumentError if a robot fails before all are there."""
    there = False
    while world.poll() is None and not there:
        there = bool(select.select([world.stdout], [], [], 0.2)[0])
        for name, robot in robots.items():
            if not there and robot.poll():
                raise DocumentError(f"swarm: expected {len(robots)} robots, but {name} has ended")
    world.wait()


def table(figures: dict) -> str:
    """Return figures as a table."""
    shown = {key: value for key, value in figures.items() if not isinstance(value, dict | list | tuple)}
    rows = [f"| {key} | {round(value, 6) if isinstance(value, float) else value} |" for key, value in shown.items()]
    return "\n".join(["| figure | value |", "|---|---|", *rows])
