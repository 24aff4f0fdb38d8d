"""A mission by processes of robots is that of one process; a robot without pose or link stands; it costs little."""

import copy
import re
import time
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import Broadcast, SeenItem, Sensed
from clean_swarm_env.tasks.cleaning.garbage import DONE
from examples.robots.bodies import ServedBodies, tick_together
from selector.documents.errors import DocumentError
from selector.documents.plain import short
from selforg.components.sensors import Lidar
from tests.clean_swarm_env.robots.lock_step import Both, poses_of, same_course

SHORT = [
    ({"base": "table1", "time_limit": 60.0}, "MaxScore"),
    ({"base": "exploring", "time_limit": 30.0}, "fsm:recent-finds"),
    ({"base": "exploring", "time_limit": 30.0}, "policy:exploring-ppo"),
    ({"base": "cleaning-patrol", "time_limit": 30.0}, "policy:one"),
    ({"base": "bumpers", "time_limit": 40.0}, "Random"),
    ({"base": "three-rooms", "time_limit": 30.0}, "Random"),
    ({"task": "ReachGoal", "time_limit": 30.0}, "Random"),
    ({"task": "Foraging", "time_limit": 30.0}, "MaxScore"),
    ({"task": "FormationControl", "time_limit": 10.0}, "Random"),
    ({"task": "MaxValue", "time_limit": 5.0}, "Random"),
]
WHOLE = [
    ("table1", "MaxScore"),
    ("exploring", "fsm:recent-finds"),
    ("exploring", "policy:exploring-ppo"),
    ("cleaning-patrol", "policy:one"),
    ("bumpers", "Random"),
    *((task, "MaxScore") for task in (
        "AgentCollisionAvoidance", "CircleFormation", "CollectiveExploration", "CollisionAvoidance", "FindBarycenter",
        "FollowMaxPotential", "FollowPotentialField", "Foraging", "FormationControl", "IndividualExploration",
        "MaxValue", "ReachGoal", "UniformDistribution",
    )),
]  # fmt: skip
HERE = Sensed(stamp=0.0, x=2.0, y=3.0, heading=0.5)


@pytest.mark.parametrize(("mission", "strategy"), SHORT)
def test_processes_in_lock_step_have_the_course_of_one_process(mission, strategy):
    same_course(mission, strategy, seed=2)


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(("mission", "strategy"), WHOLE)
def test_whole_missions_of_processes_have_the_course_of_one_process(mission, strategy, seed):
    same_course(mission, strategy, seed)


@pytest.mark.parametrize("name", ["lab-crazyflie", "lab-epuck2", "lab-kilobot", "lab-turtlebot4"])
def test_missions_of_a_laboratory_do_not_jam_as_they_come(name):
    wall = {"walls": [{"corners": [[5.5, 0.0], [5.5, 4.0]]}]}
    small = {"base": name, "robots": {"count": 3}, "world": wall, "task": {"garbage": {"count": 6}}}
    result = Both(small, "MaxScore", 1).result
    assert (result.garbage_done, result.completed) == (6, True)


def test_copies_of_bodies_and_robots_go_on_as_these_do_by_themselves():
    both = Both({"base": "table1", "time_limit": 20.0, "delivery": {"loss": 0.3, "delay": 0.4}}, "MaxScore", 2)
    first = both.bodies(), both.robots()
    for _ in range(30):
        tick_together(*first)
    second = copy.deepcopy(first)
    for bodies, robots in (first, second):
        for tick in range(30, len(both.course)):
            tick_together(bodies, robots)
            np.testing.assert_array_equal(poses_of(bodies.worlds), both.course[tick], f"tick {tick}")


def test_a_mission_of_processes_is_recorded_with_what_they_hold(tmp_path):
    both = Both({"base": "table1", "time_limit": 8.0}, "fixed:RepulsionGradient-view1.5", 2)
    robots = both.robots(record=RecordSettings(tmp_path))
    bodies = ServedBodies(both.mission, both.start, both.seed, record=RecordSettings(tmp_path, name="bodies"))
    while bodies.running:
        tick_together(bodies, robots)
    for robot in robots:
        robot.close()
    assert len(list(tmp_path.glob("*.swarm"))) == 6
    for name, frames in {"bodies": 40, "robot_0": 39}.items():  # a robot notes a period in the next one
        run = RecordedMission(tmp_path / f"{name}.swarm")
        assert run.frames == frames
        held = run["held/AvoidCollision"][-1, 0]
        assert run.head["options"]["AvoidCollision"][held] == "RepulsionGradient-view1.5"
        np.testing.assert_allclose(run["x"][1:, 0], np.array(both.course)[: frames - 1, 0, 0], atol=2e-3)


def cleaning(robot, *loads):
    """Let a robot sense and decide, once a control period, with what it has loaded and whether that is recycled."""
    for tick, (cargo, recycled) in enumerate(loads):
        items = {} if cargo or recycled is None else {0: SeenItem(2.05, 3.0)}
        robot.sense(Sensed(0.2 * tick, 2.0, 3.0, 0.0, items=items, cargo=cargo, recycled=bool(recycled)))
        robot.step(0.2 * tick)
    robot.step(0.2 * len(loads))
    robot.close()


def test_the_recording_of_a_robot_begins_where_it_is_and_counts_what_it_dumps(tmp_path):
    robot = RobotProcess("table1", 1, record=RecordSettings(tmp_path))
    cleaning(robot, ((), False), ((0,), False), ((0,), True), ((), None), ((), None))
    run = RecordedMission(tmp_path / "robot_1.swarm")
    np.testing.assert_allclose([run[name][0, 1] for name in ("x", "y", "heading")], [2.0, 3.0, 0.0])
    assert run["dumped"][:, 0].tolist() == [0, 0, 1, 1, 1]  # sensed before the next period
    assert run["item_stage"][-1, 0] == DONE


def test_the_recording_of_a_robot_keeps_the_time_and_no_other_file(tmp_path):
    for begins in (0.0, 60.0):
        robot = RobotProcess("table1", 0, record=RecordSettings(tmp_path))
        for now in (begins, begins + 0.2, begins + 1.0, begins + 1.2):
            robot.sense(Sensed(stamp=now, x=2.0 + now / 100.0, y=3.0, heading=0.0))
            robot.step(now)
        robot.close()
    first, second = (RecordedMission(tmp_path / f"{name}.swarm") for name in ("robot_0", "robot_0-2"))
    assert (first.frames, second.frames) == (6, 306)
    np.testing.assert_allclose(second["x"][[0, 300, -1], 0], [2.6, 2.6, 2.61], atol=2e-3)
    robot = RobotProcess("table1", 0, record=RecordSettings(tmp_path))
    robot.step(1.7e9)  # a clock that is wrong ends the recording with the mission
    robot.close()
    assert RecordedMission(tmp_path / "robot_0-3.swarm").frames == 15_000


def test_a_robot_without_a_pose_stands_and_one_with_a_pose_drives():
    robot = RobotProcess("table1", 0)
    assert robot.step(0.0).stopped == "pose"
    robot.sense(HERE)
    assert [robot.step(0.2 * tick).stopped for tick in range(5)] == [""] * 5
    assert robot.step(1.0) == robot.step(1.0)
    assert robot.step(1.0).speed + abs(robot.step(1.0).turn_rate) > 0.0


def test_the_wheels_stop_at_the_timeout_of_the_pose_and_go_on_with_a_new_one():
    robot = RobotProcess("table1", 1, timeout=0.5)
    robot.sense(HERE)
    assert not robot.step(0.4).stopped
    stopped = robot.step(0.6)
    assert (stopped.speed, stopped.turn_rate, stopped.vector, stopped.stopped) == (0.0, 0.0, (0.0, 0.0), "pose")
    assert not robot.say(0.8).emitted  # a robot that does not know where it is tells no pose
    robot.sense(Sensed(stamp=1.0, x=2.0, y=3.0, heading=0.5))
    assert not robot.step(1.0).stopped


def test_the_wheels_stop_without_a_link_if_there_has_to_be_one():
    robot, other = (RobotProcess("table1", number, link_timeout=1.0) for number in range(2))
    for now in (0.0, 0.6, 1.2, 1.8):
        robot.sense(Sensed(stamp=now, x=2.0, y=3.0, heading=0.5))
        other.sense(Sensed(stamp=now, x=6.0, y=3.0, heading=0.5))
        assert robot.hear(other.say(now))
        assert not robot.step(now).stopped
    robot.sense(Sensed(stamp=3.0, x=2.0, y=3.0, heading=0.5))
    assert robot.step(3.0).stopped == "link"


def driving(**more):
    """A robot of a team of two that drives straight on, and its mission."""
    mission = {"task": "AgentCollisionAvoidance", "robots": {"count": 2, "command_timeout": 5.0, **more}}
    return RobotProcess(mission, 0, "fixed:ORCA", timeout=0.5, link_timeout=1.0)


def at(robot, now, stamp=None):
    """Sense, hear the other and step at a time; return the wheels."""
    robot.sense(Sensed(stamp=now if stamp is None else stamp, x=2.0, y=3.0, heading=0.0))
    robot.step(now)
    robot.hear(Broadcast("robot_1", sequence=round(10 * now), stamp=now))
    return robot.step(now)


def test_the_wheels_stop_where_a_clock_is_wrong():
    robot = driving()
    assert at(robot, 0.2, stamp=0.9).stopped == ""  # clocks differ a bit
    assert at(robot, 0.4, stamp=1.7e9).stopped == "pose"
    assert at(robot, 19.8).stopped == ""
    assert at(robot, 5.0).stopped == "clock"
    assert at(robot, 20.0).stopped == ""
    for now in (np.nan, np.inf):
        with pytest.raises(
            DocumentError, match=r"robot_0: expected a finite time since the mission began, got (nan|inf)"
        ):
            robot.step(now)


def test_what_is_heard_late_is_no_link():
    robot = driving()
    assert at(robot, 30.0).stopped == ""
    robot.sense(Sensed(stamp=32.0, x=2.0, y=3.0, heading=0.0))
    robot.step(32.0)
    assert robot.hear(Broadcast("robot_1", sequence=400, stamp=30.5))
    assert robot.step(32.0).stopped == "link"


def test_wheels_of_a_robot_do_not_slip_by_the_mission():
    slipping, exact = driving(slip=0.5), driving()
    for now in np.arange(1, 40) / 5.0:
        assert at(slipping, now) == at(exact, now)


def test_between_control_periods_the_wheels_follow_the_newest_heading():
    robot = RobotProcess("table1", 0)
    robot.sense(HERE)
    first = [robot.step(0.2 * tick) for tick in range(5)][-1]
    robot.sense(Sensed(stamp=0.9, x=2.0, y=3.0, heading=-2.0))
    assert robot.step(0.9).turn_rate != first.turn_rate


def test_a_pose_is_forgotten_a_second_after_it_was_heard():
    robot, other = RobotProcess("table1", 0), RobotProcess("table1", 1)
    known = []
    for tick in range(12):
        now = 0.2 * tick
        robot.sense(Sensed(stamp=now, x=2.0, y=3.0, heading=0.0))
        other.sense(Sensed(stamp=now, x=3.0, y=3.0, heading=0.0))
        if tick <= 2:
            robot.hear(other.say(now))
        robot.step(now)
        known.append(bool(robot.worlds.minds.poses.known[1]))
    assert known == [True] * 8 + [False] * 4  # the last one is heard at 0.4 s, and is gone at 1.6 s


@pytest.mark.parametrize(("near", "way"), [((), 0.0), (((3.5, 8.0),), -0.5), (((2.5, 8.0),), 0.5)])
def test_a_robot_with_bumpers_backs_off_from_what_is_near(near, way):
    robot = RobotProcess("bumpers", 0, "Random")
    for tick in range(16):
        robot.sense(Sensed(0.2 * tick, 3.0, 8.0, 0.0, collisions=int(tick == 2), near=near))
        wheels = robot.step(0.2 * tick)
    assert wheels.vector == (way, 0.0)


def test_rays_end_at_what_is_near():
    robot = RobotProcess("table1", 0)
    lidar = Lidar(robot.worlds.minds.surroundings, farthest=3.0, things=0.0)
    ways = []
    for near in ((), ((4.0, 8.0),), ((4.0, 8.0), (3.5, 8.0)), ()):
        robot.sense(Sensed(0.0, 3.0, 8.0, 0.0, near=near))
        ways += lidar.read(np.array([0])).tolist()
    np.testing.assert_allclose(ways, [3.0, 0.75, 0.25, 3.0])


def test_a_robot_picks_what_it_is_at_and_believes_its_gripper():
    robot = RobotProcess("table1", 0)
    item = {3: SeenItem(2.05, 3.0)}
    begun = []
    for tick in range(10):
        robot.sense(Sensed(stamp=0.2 * tick, x=2.0, y=3.0, heading=0.0, items=item))
        begun += robot.step(0.2 * tick).handles
    assert begun == ["PickGarbage"]
    ways = []
    for tick in range(10, 20):
        robot.sense(Sensed(stamp=0.2 * tick, x=2.0, y=3.0, heading=0.0, cargo=(3,)))
        ways.append(robot.step(0.2 * tick).vector)
    to_recycling = np.array([0.75, 2.5])
    np.testing.assert_allclose(ways[-1], to_recycling / np.hypot(*to_recycling), atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"number": 5}, r"^robot: expected a number from 0 to 4, got 5$"),
        ({"mission": "scouts"}, r"^robot: expected robots that carry items, got some that only find them"),
        ({"mission": "transport"}, r"^robot: expected options that do not ask for its cargo \(Transport\)"),
        ({"mission": "silent-zone"}, r"^mission silent-zone: expected walls and zones that let messages pass"),
        ({"mission": "ReachGoal", "strategy": "baseline"}, r"^baseline: expected a strategy that chooses options"),
    ],
)
def test_what_a_robot_cannot_do_by_itself_is_one_line(wrong, says):
    with pytest.raises(DocumentError, match=says):
        RobotProcess(**{"mission": "table1", "number": 0, **wrong})


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"mission": {}}, r"robot: mission: expected a name, a path, or keys of a mission, got {}"),
        ({"mission": None}, r"robot: mission: expected a name, a path, or keys of a mission, got None"),
        ({"number": "robot_0"}, r"robot: expected a number from 0 to 4, got 'robot_0'"),
        ({"number": 1.0}, r"robot: expected a number from 0 to 4, got 1.0"),
        ({"seed": "1"}, r"robot: seed: expected a whole number from 0 on, got '1'"),
        ({"timeout": 10**400}, f"robot: timeout: expected seconds, 0 for that of its model, got {short(10**400)}"),
        ({"seed": -1}, r"robot: seed: expected a whole number from 0 on, got -1"),
        ({"timeout": -1}, r"robot: timeout: expected seconds, 0 for that of its model, got -1"),
        ({"link_timeout": 0.0}, r"robot: link_timeout: expected more than 0 s, got 0.0"),
        ({"record": "folder"}, r"robot: record: expected RecordSettings, got 'folder'"),
    ],
)
def test_settings_that_are_impossible_are_one_line(wrong, says):
    with pytest.raises(DocumentError, match=f"^{re.escape(says)}$"):
        RobotProcess(**{"mission": "table1", "number": 0, **wrong})


LIES = SeenItem(1.0, 1.0)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"x": float("nan")}, "sensed: x: expected a finite number, got nan"),
        ({"x": "2.0"}, "sensed: x: expected a finite number, got '2.0'"),
        ({"stamp": None}, "sensed: stamp: expected a finite number, got None"),
        ({"heading": 90.0}, "sensed: heading: expected radians, from -7 to 7, got 90.0"),
        ({"x": -3.0}, "sensed: pose: expected a place on the ground, 11 x 11, got (-3.0, 3.0)"),
        ({"y": 1e6}, "sensed: pose: expected a place on the ground, 11 x 11, got (2.0, 1000000.0)"),
        ({"collisions": -1}, "sensed: collisions: expected a whole number from 0 on, got -1"),
        ({"collisions": 10**30}, f"sensed: collisions: expected a whole number from 0 on, got {10**30}"),
        ({"x": 10**400}, f"sensed: x: expected a finite number, got {short(10**400)}"),
        ({"near": ""}, "sensed: near: expected places (x, y), got ''"),
        ({"near": {(1.0, 1.0)}}, "sensed: near: expected places (x, y), got {(1.0, 1.0)}"),
        ({"near": ({1.0, 2.0},)}, "sensed: near: expected places (x, y), got ({1.0, 2.0},)"),
        ({"cargo": (1,), "recycled": "False"}, "sensed: recycled: expected True or False, got 'False'"),
        ({"near": (2.5, 3.0)}, "sensed: near: expected places (x, y), got (2.5, 3.0)"),
        ({"items": [LIES]}, f"sensed: items: expected SeenItem by numbers from 0 on, got [{LIES}]"),
        ({"items": {"a": LIES}}, f"sensed: items: expected SeenItem by numbers from 0 on, got {{'a': {LIES}}}"),
        ({"items": {10: LIES}}, "sensed: items and cargo: expected numbers below 10, got 10"),
        (
            {"items": {1: SeenItem(50.0, 1.0)}},
            "sensed: item 1: expected a place on the ground, 11 x 11, got (50.0, 1.0)",
        ),
        ({"cargo": 1}, "sensed: cargo: expected numbers of items from 0 on, got 1"),
        ({"cargo": (77,)}, "sensed: items and cargo: expected numbers below 10, got 77"),
        ({"cargo": (1, 2)}, "sensed: cargo: expected at most 1 at a time (carries), got (1, 2)"),
        ({"cargo": (1,), "items": {1: LIES}}, "sensed: cargo: expected items that do not lie, got (1,)"),
        ({"recycled": True}, "sensed: recycled: expected False without cargo, got True"),
    ],
)
def test_sensors_that_are_broken_are_one_line(wrong, says):
    robot = RobotProcess("table1", 0)
    with pytest.raises(DocumentError, match=f"^{re.escape(says)}$"):
        robot.sense(Sensed(**{"stamp": 0.0, "x": 2.0, "y": 3.0, "heading": 0.5, **wrong}))
    robot.sense(HERE)  # it goes on with the next one
    assert robot.step(0.0).stopped == ""


@pytest.mark.parametrize(
    ("call", "given", "says"),
    [
        ("sense", {}, "robot_0: sense: expected Sensed, got {}"),
        ("hear", b"abc", "robot_0: hear: expected a Broadcast, as `Radio.decode` returns, got b'abc'"),
        ("hear", Broadcast("robot_1", 0, "now"), "robot_0: hear: expected a Broadcast, as `Radio.decode` returns, got"),
        ("step", None, "robot_0: expected a finite time since the mission began, got None"),
        ("step", 1.8e18, "robot_0: expected a finite time since the mission began, got 1.8e+18"),
    ],
)
def test_what_is_no_message_is_one_line(call, given, says):
    with pytest.raises(DocumentError, match=f"^{re.escape(says)}"):
        getattr(RobotProcess("table1", 0), call)(given)


def test_a_pose_may_lie_beside_the_ground_by_its_error():
    robot = RobotProcess("table1", 0)
    robot.sense(Sensed(stamp=0.0, x=-0.02, y=11.03, heading=6.29))
    np.testing.assert_allclose(robot.worlds.physics.positions[0], [10.98, 0.03])


@pytest.mark.parametrize(
    ("example", "prints"),
    [
        ("lab_robot", r"The robots drove 1\d\d\.\d m within 60 s\.\n"),
        ("one_row", r"The robot went from \[0, 0\] to \[-0\.8 -0\.4\], away from the other at \[1, 0\.5\]\.\n"),
    ],
)
def test_examples_of_robots_drive_in_forty_lines(example, prints, capsys):
    module = import_module(f"examples.robots.{example}")
    assert len(Path(module.__file__).read_text(encoding="utf-8").splitlines()) <= 40
    module.main()
    assert re.fullmatch(prints, capsys.readouterr().out)


@pytest.mark.long
def test_robots_clean_in_a_simulator_of_ones_own(capsys):
    import_module("examples.robots.own_simulator").main()
    assert re.fullmatch(r"10 of 10 items were dumped within [1-5]\d\d s\.\n", capsys.readouterr().out)


@pytest.mark.long
def test_a_robot_at_50_hz_takes_at_most_two_per_cent_of_a_core():
    robots = [RobotProcess("table1", number) for number in range(5)]
    spent = 0.0
    for call in range(50 * 60):
        now = call / 50.0
        for number, robot in enumerate(robots):
            before = time.process_time()
            robot.sense(Sensed(stamp=now, x=1.0 + 2.0 * number + 0.01 * np.sin(now), y=5.0, heading=0.5))
            if call % 10 == 0:
                said = robot.say(now)
            robot.step(now)
            spent += (time.process_time() - before) * (number == 0)
            if call % 10 == 0:
                for other in robots:
                    before = time.process_time()
                    other.hear(said)
                    spent += (time.process_time() - before) * (other is robots[0])
    assert spent < 0.02 * 60.0


def test_a_mission_without_items_drives():
    robot = RobotProcess({"base": "table1", "task": {"garbage": {"count": 0}}}, 0)
    robot.sense(HERE)
    assert robot.step(0.0).stopped == ""
