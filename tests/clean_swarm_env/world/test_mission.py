"""Whole missions complete under every option, and their results are right."""

import pytest

from clean_swarm_env.config.starts import run_seed
from clean_swarm_env.learning.batch import run_out
from clean_swarm_env.world.mission import result_of
from tests.clean_swarm_env.courses import OPTIONS, course_of, forced, long_course, mission, ticked, worlds_at_start


@long_course
@pytest.mark.parametrize("name", ["table1", "reference"])
@pytest.mark.parametrize("option", OPTIONS)
def test_whole_missions_complete_by_each_option(name, option):
    worlds = worlds_at_start(mission(name), [1], OPTIONS.index(option))
    while worlds.task.garbage.done[0] < 10:
        worlds.tick()
    result = run_out(forced(course_of(worlds.mission, 1, run_seed(1, "test")), AvoidCollision=option))
    assert result == result_of(worlds, 0)
    assert (result.completed, result.garbage_done, result.robots) == (True, 10, 5)
    assert 30.0 < result.duration_s == pytest.approx((result.ticks - 1) * 0.2)
    assert result.items_per_min == pytest.approx(60.0 * 10 / (result.ticks * 0.2))
    near, far = result.collision_samples_per_s
    assert 0.0 < result.collision_events_per_s[0] < near < far < 20.0 * 10  # ten pairs, 20 counts a second


@long_course
@pytest.mark.parametrize("robots", [1, 2, 12])
def test_few_and_many_robots_clean_up(robots):
    config = mission(robots={"count": robots})
    result = run_out(forced(course_of(config, 4, 4), AvoidCollision="RepulsionGradient-view1.5"))
    assert result.completed


def test_a_mission_ends_at_its_time_limit():
    config = mission(time_limit=20.0)
    result = run_out(course_of(config, 1, 1))
    assert not result.completed
    assert result.duration_s == 20.0
    assert result.ticks == 100
    assert result.garbage_done < 10


def test_a_mission_without_garbage_is_over_after_its_first_control_period():
    config = mission(garbage={"count": 0})
    result = run_out(course_of(config, 1, 1))
    assert (result.completed, result.duration_s, result.ticks) == (True, 0.0, 1)
    assert result.collision_samples_per_s == (0.0, 0.0)


def test_garbage_keeps_coming_at_its_rate_whatever_robots_do():
    config = mission(garbage={"count": 2, "respawn": 30.0, "capacity": 500}, time_limit=600.0)
    arrived = []
    for option in (0, 2):
        worlds = ticked(worlds_at_start(config, [1], option), 1500)
        assert not worlds.done[0]
        arrived.append(int(worlds.task.garbage.arrived[0]))
    assert arrived[0] == arrived[1]
    assert arrived[0] - 2 == pytest.approx(150, abs=3 * 150**0.5)


def test_items_without_room_are_lost():
    config = mission(garbage={"count": 2, "respawn": 60.0, "capacity": 5}, time_limit=600.0)
    worlds = ticked(worlds_at_start(config, [1]), 60)
    assert (worlds.task.garbage.stage[0] < 2).sum() == 5
    assert worlds.minds.buffers["items"].count(0, "garbage") == (worlds.task.garbage.stage[0] == 0).sum()


def test_a_mission_waits_for_garbage_that_is_still_to_land():
    config = mission("reference", garbage={"count": 0}, events=[{"at": 10.0, "do": "land", "items": 2}])
    result = run_out(course_of(config, 1, 1))
    assert result.completed
    assert result.garbage_done == 2
    assert result.duration_s > 10.0
