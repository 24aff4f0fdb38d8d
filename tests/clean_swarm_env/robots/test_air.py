"""Through the air of a mission, with its range, losses and delay, processes have the course of one process."""

import numpy as np
import pytest

from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import Sensed
from selforg.gradients.queries import Filter, Queries
from tests.clean_swarm_env.robots.lock_step import Both, poses_of, same_course

BAD = {"reach": 3.0, "loss": 0.3, "delay": 0.4}
LATER = [{"at": 5.0, "do": "deliver", "loss": 0.6, "reach": 2.0}]


@pytest.mark.parametrize(
    ("mission", "strategy"),
    [
        ({"base": "table1", "time_limit": 40.0, "delivery": BAD}, "MaxScore"),
        ({"base": "table1", "time_limit": 20.0, "delivery": {"loss": 0.3}}, "Random"),
        ({"base": "table1", "time_limit": 20.0, "delivery": {"delay": 0.6}}, "MaxScore"),
        ({"base": "table1", "time_limit": 20.0, "robots": {"message_range": 2.0}}, "MaxScore"),
        ({"base": "table1", "time_limit": 20.0, "events": LATER}, "MaxScore"),
        ({"base": "exploring", "time_limit": 30.0, "delivery": BAD}, "fsm:recent-finds"),
        ({"base": "exploring", "time_limit": 30.0, "delivery": BAD}, "policy:exploring-ppo"),
        ({"task": "Foraging", "time_limit": 30.0, "delivery": BAD}, "MaxScore"),
        ({"task": "MaxValue", "time_limit": 5.0, "delivery": BAD}, "Random"),
    ],
)
def test_range_losses_and_delay_are_those_of_one_process(mission, strategy):
    same_course(mission, strategy, seed=2)


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(
    ("mission", "strategy"),
    [
        *(("table1", one) for one in ("MaxScore", "Random")),
        *(("exploring", one) for one in ("fsm:recent-finds", "policy:exploring-ppo")),
        ("cleaning-patrol", "policy:one"),
        ("bumpers", "Random"),
    ],
)
def test_whole_missions_with_losses_are_those_of_one_process(mission, strategy, seed):
    same_course({"base": mission, "delivery": BAD}, strategy, seed)


@pytest.mark.long
@pytest.mark.parametrize(
    "task",
    [
        *("AgentCollisionAvoidance", "CircleFormation", "CollectiveExploration", "CollisionAvoidance"),
        *("FindBarycenter", "FollowMaxPotential", "FollowPotentialField", "Foraging", "IndividualExploration"),
        *("MaxValue", "ReachGoal", "UniformDistribution"),
    ],
)
def test_tasks_with_losses_are_those_of_one_process(task):
    same_course({"task": task, "delivery": BAD}, "MaxScore", 1)


def test_queries_from_outside_change_no_course():
    def look(worlds):
        for buffer in worlds.minds.buffers.values():
            Queries(buffer).gather(worlds.now, look=Filter(view_distance=np.inf))
            buffer.evaporate(worlds.now)
        return poses_of(worlds)

    mission = {"task": "Foraging", "time_limit": 170.0, "delivery": {"reach": 3.0}}
    alone, looked_at = (Both(mission, "MaxScore", 1, watch) for watch in (None, look))
    np.testing.assert_array_equal(alone.course, looked_at.course)  # they parted in tick 807


def test_the_course_depends_on_what_gets_lost():
    exact, lossy = (Both({"base": "table1", "time_limit": 20.0, "delivery": one}, "MaxScore", 2) for one in ({}, BAD))
    assert any((one != other).any() for one, other in zip(exact.course, lossy.course, strict=True))


def test_a_robot_has_what_it_leaves_itself_after_the_delay_of_its_mission():
    robots = [RobotProcess({"base": "exploring", "delivery": {"delay": delay}}, 0) for delay in (0.0, 0.6)]
    known = []
    for tick in range(8):
        now = 0.2001 * tick
        for robot in robots:
            robot.sense(Sensed(stamp=now, x=2.0 + 0.3 * tick, y=3.0, heading=0.0))
            robot.say(now)
            robot.step(now)
        known.append([sum(map(len, robot.worlds.minds.buffers.values())) for robot in robots])
    assert known[2][0] > known[2][1]
