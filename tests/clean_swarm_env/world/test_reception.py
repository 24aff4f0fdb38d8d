"""Messages with a range and losses: the poses and pheromones that each robot has received, world by world."""

from types import MappingProxyType

import numpy as np
import pytest

from clean_swarm_env.config.mission import StartConfiguration
from selforg.gradients.queries import Filter, Queries
from tests.clean_swarm_env.courses import course, difference, long_course, mission, worlds_at_start


def _still(delivery, places=((1.0, 5.0), (3.0, 5.0), (6.0, 5.0)), robots=MappingProxyType({}), **changes):
    """Robots in a row that stand still."""
    config = mission(robots={"count": len(places), **robots}, garbage={"count": 0}, delivery=delivery, **changes)
    worlds = worlds_at_start(config, [1])
    start = StartConfiguration(id="row", robots=tuple((x, y, 0.0) for x, y in places), items=())
    worlds.reset(0, start, 1)
    return worlds


def _spread(worlds, ticks=1):
    """Spread poses as in a tick, without moving; return the number of poses that each robot sees."""
    for _ in range(ticks):
        worlds.minds.spread_poses(worlds.physics.positions, worlds.physics.headings, worlds.now)
        worlds.minds.receive(worlds.now)
        worlds.clock.packed.record.ticks[0] += 1
    everything = Filter(static=False, view_distance=np.inf)
    return [
        len(Queries(worlds.minds.buffers["gradients"]).gradients(row, worlds.now, everything))
        for row in range(worlds.rows)
    ]


def _errors(worlds, ticks):
    """Spread poses tick by tick; return how wrong each of them was."""
    found = []
    for _ in range(ticks):
        _spread(worlds)
        found.append(worlds.minds.poses.positions - worlds.physics.positions)
    return found


def test_poses_reach_robots_within_range():
    assert _spread(_still({"reach": 2.5})) == [1, 1, 0]
    assert _spread(_still({"reach": 3.5})) == [1, 2, 1]
    assert _spread(_still({"own_contents": True})) == [2, 2, 2]
    assert _spread(_still({"loss": 1.0})) == [0, 0, 0]


def test_a_pose_is_kept_for_its_time_and_then_forgotten():
    worlds = _still({"own_contents": True, "pose_memory": 0.6})
    assert _spread(worlds) == [2, 2, 2]
    worlds.minds.reception.set(0, 1.0, 0.0)
    worlds.physics.positions[0, 0] += 0.5
    assert _spread(worlds) == [2, 2, 2]
    seen = Queries(worlds.minds.buffers["gradients"]).gradients(
        1, worlds.now, Filter(static=False, view_distance=np.inf)
    )
    assert sorted(gradient.position[0] for gradient in seen) == [1.0, 6.0]  # where robot 0 was when last heard
    assert _spread(worlds, 2) == [2, 2, 2]
    assert _spread(worlds) == [0, 0, 0]


def test_losses_have_the_given_probability():
    worlds = _still({"loss": 0.3, "pose_memory": 0.0}, tuple((0.3 + 1.1 * k, 5.0) for k in range(9)))
    seen = [_spread(worlds) for _ in range(300)]
    # a pose of the tick before is still kept: it is missed where two in a row are lost
    assert np.mean(seen) == pytest.approx((1.0 - 0.3**2) * 8, rel=0.01)


def test_pheromones_reach_robots_within_range_and_the_one_that_left_them():
    worlds = _still({"reach": 2.5})
    _spread(worlds)
    worlds.task.movers.mechanisms["Patrol"].deposit(worlds.now, np.array([0]))
    trail = Filter(("pheromone",), moving=False, view_distance=np.inf)
    known = [len(Queries(worlds.minds.buffers["pheromones"]).gradients(row, worlds.now, trail)) for row in range(3)]
    assert known == [1, 1, 0]


@pytest.mark.parametrize("way", ["remove", "fail"])
@pytest.mark.parametrize("delay", [0.0, 0.2])
def test_robots_that_no_longer_work_hold_no_pheromones_and_receive_none(way, delay):
    worlds = _still({"reach": 2.5, "delay": delay})
    _spread(worlds)
    worlds.task.movers.mechanisms["Patrol"].deposit(worlds.now, np.array([0]))
    _spread(worlds, 2)
    assert worlds.minds.buffers["pheromones"].count(0, "pheromone") == 2
    worlds.task.movers.mechanisms["Patrol"].deposit(worlds.now, np.array([0]))
    getattr(worlds.team, way)(np.array([1]))  # with a delay its message is under way
    for _ in range(2):
        _spread(worlds, 2)
        assert worlds.minds.buffers["pheromones"].count(0, "pheromone") == 1
        worlds.task.movers.mechanisms["Patrol"].deposit(worlds.now, np.array([0]))


def test_messages_arrive_after_their_delay():
    worlds = _still({"delay": 0.6})
    assert [_spread(worlds) for _ in range(4)] == [[0, 0, 0], [0, 0, 0], [0, 0, 0], [2, 2, 2]]
    worlds.physics.positions[0, 0] = 1.5
    everything, seen = Filter(static=False, view_distance=np.inf), []
    for _ in range(4):
        _spread(worlds)
        poses = Queries(worlds.minds.buffers["gradients"]).gradients(1, worlds.now, everything)
        seen.append(sorted(pose.position[0] for pose in poses))
    assert seen == [[1.0, 6.0]] * 3 + [[1.5, 6.0]]
    worlds.task.movers.mechanisms["Patrol"].deposit(worlds.now, np.array([0]))
    trails = []
    for _ in range(4):
        trails.append(worlds.minds.buffers["pheromones"].count(0, "pheromone"))
        _spread(worlds)
    assert trails == [0, 0, 0, 0]
    assert worlds.minds.buffers["pheromones"].count(0, "pheromone") == 3


def test_a_pose_that_came_late_is_kept_for_its_time_from_then_on():
    worlds = _still({"delay": 0.4, "pose_memory": 0.6})
    assert _spread(worlds, 3) == [2, 2, 2]
    worlds.minds.reception.set(0, 1.0, 0.0)
    assert _spread(worlds, 3) == [2, 2, 2]
    assert _spread(worlds) == [0, 0, 0]


def test_a_drift_of_poses_begins_at_the_start_has_its_size_and_changes_slowly():
    worlds = _still({"own_contents": True}, robots={"pose_drift": 0.2})
    errors = _errors(worlds, 8000)
    assert np.abs(errors[0]).max() < 0.1
    assert np.std(errors) == pytest.approx(0.2, rel=0.25)
    later = [np.corrcoef(np.ravel(errors[:-lag]), np.ravel(errors[lag:]))[0, 1] for lag in (1, 100, 1000)]
    assert later == pytest.approx([np.exp(-1.0 / 100.0), np.exp(-1.0), 0.0], abs=0.2)
    assert later[0] == pytest.approx(np.exp(-1.0 / 100.0), abs=0.003)


def test_errors_of_poses_have_their_size_and_are_those_that_all_see():
    worlds = _still({"own_contents": True}, robots={"pose_noise": 0.2})
    errors = _errors(worlds, 2000)
    assert np.std(errors) == pytest.approx(0.2, rel=0.03)
    assert abs(np.mean(errors)) < 0.01
    assert np.corrcoef(np.reshape(errors, (-1, 6)).T) == pytest.approx(np.eye(6), abs=0.1)
    everything = Filter(static=False, view_distance=np.inf)
    seen = {
        gradient.position
        for gradient in Queries(worlds.minds.buffers["gradients"]).gradients(0, worlds.now, everything)
    }
    assert seen == {tuple(place) for place in worlds.minds.poses.positions[1:].tolist()}


@long_course
@pytest.mark.parametrize("contacts", ["solid", "pass_through"])
def test_contents_of_their_own_change_nothing_while_all_arrives(contacts):
    shared = course(worlds_at_start(mission(world={"contacts": contacts}), [5], 0), 0, 500)
    own = mission(world={"contacts": contacts}, delivery={"own_contents": True})
    assert difference(shared, course(worlds_at_start(own, [5], 0), 0, 500)) == ""


def test_a_robot_out_of_reach_that_goes_changes_nothing_for_the_others_losses():
    places = ((5.0, 5.0), (6.0, 5.0), (5.5, 6.5), (30.0, 30.0))
    courses = []
    for goes in (False, True):
        worlds = _still({"reach": 9.0, "loss": 0.5}, places, world={"width": 60.0, "height": 60.0})
        course(worlds, 0, 10)
        if goes:
            worlds.team.remove(np.array([3]))
        courses.append([step["positions"][:3].tobytes() for step in course(worlds, 0, 80)])
    assert courses[0] == courses[1]


def test_a_robot_taken_away_is_heard_no_more():
    worlds = _still({"reach": 5.0})
    assert _spread(worlds) == [2, 2, 2]
    worlds.team.remove(np.array([1]))
    assert _spread(worlds)[::2] == [1, 1]


def test_events_of_the_delivery_happen_in_their_time():
    events = [{"at": 1.0, "do": "deliver", "reach": 2.5, "loss": 0.25}, {"at": 2.0, "do": "deliver"}]
    worlds = worlds_at_start(mission(events=events), [1])
    seen = []
    for _ in range(12):
        worlds.tick()
        seen.append((float(worlds.minds.reception.reaches[0]), float(worlds.minds.reception.losses[0])))
    assert seen == [(1e9, 0.0)] * 5 + [(2.5, 0.25)] * 5 + [(1e9, 0.0)] * 2


def test_a_world_whose_robots_share_all_refuses_losses():
    with pytest.raises(ValueError, match=r"expected a mission with delivery\.own_contents"):
        worlds_at_start(mission(), [1]).minds.reception.set(0, 1.0, 0.0)
