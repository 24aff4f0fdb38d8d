"""Approaching the least busy goal, beside a naive reference in plain Python."""

import numpy as np
import pytest

from selforg.commands import Commands
from selforg.gradients.delivery import Delivery, PoseDelivery
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import ApproachLeastBusy
from selforg.space import Torus
from tests.selforg.worlds import make_world, scatter

SIDE, DT = 12.0, 0.2


def world_of(places, goals=(), **options):
    """Return a world of robots that have stood at places (R, 2) for two ticks, and goals (M, 2)."""
    settings = BufferSettings(np.inf, {"DEFAULT": "new"}, aggregation_distance=0.0)
    world = make_world(Torus(SIDE, SIDE), rows=len(places), settings=settings, **options)
    for tick in (1, 2):
        world.poses.update(np.array(places, dtype=float), np.zeros(len(places)), DT * tick)
    if len(goals):
        world.buffer.store_static(0, "goal", np.array(goals, dtype=float), DT)
    return world


def eastward(rows):
    """Return commands to go east."""
    commands = Commands(rows, 2)
    commands.vectors[:, 0], commands.commanded[:] = 0.8, True
    return commands


def steered(mechanism, now=2 * DT, rows=None):
    """Return the commands after steering."""
    commands = eastward(mechanism.poses.rows)
    mechanism.steer(now, np.arange(mechanism.poses.rows) if rows is None else rows, commands.packed.handle)
    return commands


def offset(place, other):
    return (np.array(other) - place + SIDE / 2) % SIDE - SIDE / 2


def expected(row, places, goals, weight, crowd, halt, lane):
    """Return the velocity, and whether the robot waits, in plain Python."""

    def before(goal, radius):
        own = np.hypot(*offset(places[row], goal))
        away = [np.hypot(*offset(place, goal)) for k, place in enumerate(places) if k != row]
        return sum(d < min(radius, own) for d in away)

    costs = [np.hypot(*offset(places[row], goal)) + weight * before(goal, crowd) for goal in goals]
    goal = goals[int(np.argmin(costs))]
    way = offset(places[row], goal)
    return 0.8 * way / np.hypot(*way), bool(np.hypot(*way) <= halt and before(goal, lane) > 0)


@pytest.mark.parametrize("seed", range(20))
def test_each_robot_goes_to_the_goal_of_least_way_and_crowd_or_waits(seed):
    rng = np.random.default_rng(seed)
    places, goals = rng.uniform(0, SIDE, (20, 2)), rng.uniform(0, SIDE, (3, 2))
    numbers = {"weight": float(rng.uniform(0, 4)), "crowd": 3.0, "halt": 6.0, "lane": 3.0}
    commands = steered(ApproachLeastBusy(world_of(places, goals).buffer, channels=("goal",), **numbers))
    waits = []
    for row in range(20):
        vector, waiting = expected(row, places, goals, **numbers)
        np.testing.assert_allclose(commands.vectors[row], vector, atol=1e-9)
        waits.append(waiting)
    assert commands.in_place.tolist() == waits
    assert any(waits)
    assert not all(waits)


def test_only_attractive_gradients_of_its_channels_count_and_rows_that_do_not_move_keep_their_commands():
    world = world_of([[1.0, 1.0]] * 3)
    scatter(world, 3, channel="goal", attraction=-1)
    scatter(world, 3, channel="other")
    mechanism = ApproachLeastBusy(world.buffer, channels=("goal",))
    assert np.array_equal(steered(mechanism).vectors, eastward(3).vectors)
    world.buffer.store_static(0, "goal", [[1.0, 5.0]], DT)
    commands = eastward(3)
    commands.commanded[1], commands.in_place[2] = False, True
    mechanism.steer(2 * DT, np.arange(3), commands.packed.handle)
    assert commands.vectors.round(9).tolist() == [[0.0, 0.8], [0.8, 0.0], [0.8, 0.0]]


def test_who_has_chosen_stays_with_it_until_another_goal_is_better_by_its_loyalty():
    goals, chosen = [[2.0, 6.0], [10.0, 6.0]], []
    for loyalty in (0.0, 1.0):
        world = world_of([[5.9, 6.0]], goals)
        mechanism = ApproachLeastBusy(world.buffer, loyalty=loyalty)
        steered(mechanism)
        for tick, x in enumerate((6.1, 6.4, 6.6)):
            world.poses.update(np.array([[x, 6.0]]), np.zeros(1), DT * (3 + tick))
            chosen.append(steered(mechanism, DT * (3 + tick)).vectors[0, 0] > 0.0)
    assert chosen == [True, True, True, False, False, True]
    world.poses.update(np.array([[6.4, 6.0]]), np.zeros(1), 3.0)
    mechanism.reset(np.array([0]))
    assert steered(mechanism, 3.0).vectors[0, 0] > 0.0


def test_a_robot_that_has_not_steered_for_a_while_chooses_anew():
    world = world_of([[5.9, 6.0]], [[2.0, 6.0], [10.0, 6.0]])
    mechanism = ApproachLeastBusy(world.buffer, loyalty=1.0)
    steered(mechanism)
    world.poses.update(np.array([[6.1, 6.0]]), np.zeros(1), 2.0)
    assert steered(mechanism, 2.0).vectors[0, 0] > 0.0


def test_nobody_waits_longer_than_its_patience_and_waiting_begins_anew_when_the_goal_was_free():
    world = world_of([[6.0, 6.0], [8.0, 6.0]], [[6.0, 6.0]])
    mechanism = ApproachLeastBusy(world.buffer, halt=3.0, lane=1.0, patience=2.1)
    waits = []
    for tick in range(3, 40):
        free = 20 <= tick < 22
        world.poses.update(np.array([[1.0 if free else 6.0, 6.0], [8.0, 6.0]]), np.zeros(2), DT * tick)
        waits.append(bool(steered(mechanism, DT * tick, np.array([1])).in_place[1]))
    assert waits == [*[True] * 11, *[False] * 8, *[True] * 11, *[False] * 7]


def test_a_robot_counts_only_where_its_pose_was_received():
    world = world_of([[6.5, 6.0], [2.5, 6.0]], [[2.0, 6.0], [11.5, 6.0]], history=6, hearing=True)
    delivery = PoseDelivery(world.poses, Delivery(np.array([3.0]), np.zeros(1)))
    mechanism = ApproachLeastBusy(world.buffer, weight=3.0, loyalty=0.0)
    delivery.deliver()
    assert steered(mechanism).vectors[0, 0] < 0.0
    delivery.rule.reach[0] = 9.0
    delivery.deliver()
    assert steered(mechanism).vectors[0, 0] > 0.0


def test_negative_parameters_are_refused():
    with pytest.raises(ValueError, match="ApproachLeastBusy: halt must be at least 0"):
        ApproachLeastBusy(world_of([[1.0, 1.0]]).buffer, halt=-1.0)
