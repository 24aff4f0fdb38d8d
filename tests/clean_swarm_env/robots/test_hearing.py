"""Which broadcasts count: late, twice, in the wrong order, from a robot that restarted, from nobody known."""

import numpy as np
import pytest

from clean_swarm_env.robots.hearing import EARLIEST, OLDEST, SILENCE, Ear
from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import POSE_BUFFER, Broadcast, Emitted, Sensed
from selforg.gradients.gradient import Gradient

TEAM = ("robot_0", "robot_1", "robot_2")


def heard(*said, now=100.0):
    """Return why each of (robot, sequence, stamp) does not count."""
    ear = Ear(TEAM, "robot_0")
    return [ear.refuses(Broadcast(*one), now) for one in said]


def pose(x, stamp, channel="robot", **more):
    return Emitted(POSE_BUFFER, Gradient(channel, (x, 3.0), attraction=-1, moving=True, stamp=stamp, **more))


@pytest.fixture
def robot():
    """A robot that has sensed where it is, at 1 s."""
    one = RobotProcess("table1", 0)
    one.sense(Sensed(stamp=1.0, x=2.0, y=3.0, heading=0.0))
    one.step(1.0)
    return one


def hears(robot, sequence, *emitted, stamp=1.0):
    """Let a robot hear something, and decide in the next control period; return where it believes the other to be."""
    counts = robot.hear(Broadcast("robot_1", sequence, stamp, emitted))
    robot.step(robot.worlds.now + 0.2001)
    poses = robot.worlds.minds.poses
    return counts, bool(poses.known[1]), float(poses.positions[1, 0])


def test_what_is_late_or_from_ahead_does_not_count():
    for stamp, why in (
        *((100.0, ""), (100.0 - OLDEST, ""), (99.9 - OLDEST, "late"), (100.0 + EARLIEST, ""), (np.inf, "early")),
        *((100.1 + EARLIEST, "early"), (np.nan, "late"), (-np.inf, "late")),
    ):
        assert heard(("robot_1", 0, stamp)) == [why]


def test_what_comes_twice_or_after_a_newer_one_does_not_count():
    said = [("robot_1", number, 90.0 + number) for number in (0, 0, 3, 2, 3, 4)]
    assert heard(*said) == ["", "old", "", "old", "old", ""]
    assert heard(("robot_1", 5, 99.0), ("robot_1", 6, 99.0), ("robot_1", 6, 99.0)) == ["", "", "old"]


def test_a_robot_that_restarted_with_an_old_clock_counts_once_nothing_newer_has_come():
    ear = Ear(TEAM, "robot_0")
    assert not ear.refuses(Broadcast("robot_1", 500, 99.0), 100.0)
    restarted = [Broadcast("robot_1", number, 70.0 + 0.5 * number) for number in range(8)]
    assert [ear.refuses(one, 100.0 + 0.5 * number) for number, one in enumerate(restarted)] == ["old"] * 5 + [""] * 3
    assert SILENCE == 2.0
    assert heard(("robot_1", 500, 99.0), ("robot_2", 0, 70.0)) == ["", ""]  # each robot by itself


def test_a_clock_is_wrong_if_more_robots_are_early_than_count_and_two_of_them_agree():
    ear = Ear(("robot_0", "robot_1", "robot_2", "robot_3", "robot_4"), "robot_0")
    assert ear.refuses(Broadcast("robot_1", 0, 33.0), 5.0) == "early"  # that one may be wrong itself
    assert ear.wrong_until < 0.0
    assert ear.refuses(Broadcast("robot_2", 0, 33.0), 5.1) == "early"
    assert ear.wrong_until == 5.1 + SILENCE
    assert not ear.refuses(Broadcast("robot_3", 0, 6.0), 6.0)
    assert not ear.refuses(Broadcast("robot_4", 0, 6.0), 6.0)
    assert ear.refuses(Broadcast("robot_1", 1, 34.0), 6.1) == "early"  # two say so, two do not
    assert ear.wrong_until == 5.1 + SILENCE
    pair = Ear(TEAM[:2], "robot_0")
    assert pair.refuses(Broadcast("robot_1", 0, 33.0), 5.0) == "early"
    assert pair.wrong_until == 5.0 + SILENCE  # neither can know who is wrong


def test_a_robot_that_restarted_with_a_clock_of_its_own_stands_and_says_why():
    team = [RobotProcess("table1", number) for number in range(3)]
    for tick in range(40):
        at = [33.0, 33.0, 0.0]
        for robot, begun in zip(team, at, strict=True):
            robot.sense(Sensed(stamp=begun + 0.2 * tick, x=2.0 + robot.row, y=3.0, heading=0.0))
        said = [robot.say(begun + 0.2 * tick) for robot, begun in zip(team, at, strict=True)]
        for robot in team:
            for one in said:
                robot.hear(one)
        stopped = [robot.step(begun + 0.2 * tick).stopped for robot, begun in zip(team, at, strict=True)]
    assert stopped == ["", "", "clock"]
    assert team[0].worlds.minds.poses.known.tolist()[:3] == [True, True, False]


def test_one_wrong_broadcast_silences_a_robot_for_no_longer_than_its_clock_is_ahead():
    ear = Ear(TEAM, "robot_0")
    said = [Broadcast("robot_1", 2**32 - 1, 100.0 + EARLIEST)] + [
        Broadcast("robot_1", k, 100.0 + 0.2 * k) for k in range(9)
    ]
    times = [100.0, *(one.stamp for one in said[1:])]
    why = [ear.refuses(one, now) for one, now in zip(said, times, strict=True)]
    assert why == [""] + ["old"] * 6 + [""] * 3


def test_unknown_robots_and_the_own_name_do_not_count():
    assert heard(("robot_9", 0, 99.0), ("robot_0", 0, 99.0), ("", 0, 99.0)) == ["unknown"] * 3


def test_poses_count_in_their_order_and_not_after_they_would_be_forgotten(robot):
    assert hears(robot, 0, pose(4.0, 1.0)) == (True, True, 4.0)
    assert hears(robot, 1, pose(5.0, 0.9)) == (True, True, 4.0)  # older than the one that is known
    assert hears(robot, 2, pose(6.0, 1.1), stamp=1.2) == (True, True, 6.0)
    for _ in range(6):
        robot.step(robot.worlds.now + 0.2001)
    assert hears(robot, 3, pose(7.0, 1.2), stamp=1.2) == (True, False, 6.0)  # 1.6 s old
    assert robot.ear.refused == {"old pose": 2}  # of a broadcast of which the rest counts


def test_a_robot_that_restarts_with_an_old_clock_is_where_it_says_once_its_clock_is_right(robot):
    assert hears(robot, 9, pose(4.0, 1.0)) == (True, True, 4.0)
    found = [hears(robot, number, pose(5.0, 0.02 * number), stamp=0.02 * number) for number in range(20)]
    assert [counts for counts, _, _ in found] == [False] * 9 + [True] * 11
    assert not any(known for _, known, _ in found[6:])
    now = robot.worlds.now
    assert hears(robot, 20, pose(8.0, now), stamp=now) == (True, True, 8.0)


@pytest.mark.parametrize(
    "wrong",
    [
        pose(np.nan, 1.0),
        pose(4.0, np.inf),
        pose(4.0, 1.5),  # newer than what says it
        pose(4.0, 1.0, diffusion=-1.0),
        pose(1e300, 1.0),
        pose(500.0, 1.0),  # beside the ground
        Emitted("pheromones", Gradient("pheromone", (1.0, 1.0), evaporation_factor=2.0)),
        Emitted("pheromones", Gradient("pheromone", (1.0, 1.0, 1.0))),
    ],
)
def test_a_broadcast_with_an_impossible_number_does_not_count(robot, wrong):
    assert hears(robot, 0, pose(4.0, 1.0), wrong)[:2] == (False, False)
    assert robot.ear.refused == {"impossible": 1}


def test_channels_and_keys_that_nobody_uses_fill_no_memory(robot):
    buffer = robot.worlds.minds.buffers["pheromones"]
    channels, keys = buffer.channels.names(), buffer.keys.names()
    nobody = [Emitted("pheromones", Gradient(f"channel {k}", (1.0, 1.0))) for k in range(10)]
    elsewhere = Emitted("no buffer", Gradient("pheromone", (1.0, 1.0)))
    keyed = Emitted("pheromones", Gradient("pheromone", (1.0, 1.0), payload={"new": 1.0}))
    hears(robot, 0, *nobody, elsewhere, keyed)
    assert (buffer.channels.names(), buffer.keys.names()) == (channels, keys)
    assert robot.ear.refused == {"channel or room": 11}
    assert buffer.count(0, "pheromone") >= 1


def test_a_robot_that_hears_too_much_hears_no_more_until_it_decides(robot):
    many = [Emitted("pheromones", Gradient("pheromone", (0.01 * k, 1.0))) for k in range(600)]
    counts = [robot.hear(Broadcast("robot_1", number, 1.0, tuple(many))) for number in range(4)]
    assert counts == [True, True, False, False]
    robot.step(1.2001)
    assert robot.hear(Broadcast("robot_1", 9, 1.0, tuple(many)))
