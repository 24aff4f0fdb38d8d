"""Small rules of the original's mechanisms, by their numbers in docs/quirks.md."""

import numpy as np
import pytest

from selforg.mechanisms import (
    DepositPheromonesRandom,
    Exploration,
    FollowAll,
    GossipMax,
    MorphogenesisBarycenter,
    Quorum,
)
from tests.selforg.worlds import directions, make_world


def beside(world, distance):
    """The place `distance` [m] beside the only robot, (1, 2)."""
    return world.poses.positions + np.array([distance, 0.0])


@pytest.mark.parametrize(("stored", "moves"), [((), False), ((0,), True), ((1,), True)])
def test_b4_follow_all_with_only_neutral_gradients_in_view_moves_by_zero(stored, moves):
    world = make_world(rows=1)
    for sign in stored:
        world.buffer.store_static(0, "f", beside(world, 1.0), 0.0, attraction=sign)
    vectors, active = FollowAll(world.buffer, channels=["f"]).move(0.0)
    assert active.tolist() == [moves]
    assert vectors.any() == (1 in stored)


def test_b4_a_neutral_gradient_out_of_view_is_no_movement():
    world = make_world(rows=1)
    world.buffer.store_static(0, "f", beside(world, 4.0), 0.0, attraction=0)
    assert not FollowAll(world.buffer, channels=["f"], view_distance=1.0).move(0.0)[1].any()


@pytest.mark.parametrize("walk", [Exploration, DepositPheromonesRandom])
@pytest.mark.parametrize(
    ("lowest", "highest", "length"), [(0.1, 1.0, 1.0), (0.1, 0.3, 0.3), (50.0, 100.0, 50.0), (0.5, 9.0, 1.0)]
)
def test_b7_a_random_walk_is_a_metre_per_second_long_within_the_speeds(walk, lowest, highest, length):
    world = make_world(rows=3)
    mechanism = walk(world.buffer, min_speed=lowest, max_speed=highest, directions=directions(3))
    np.testing.assert_allclose(np.linalg.norm(mechanism.move(0.0)[0], axis=1), length, rtol=1e-12)


def test_b5_without_own_pose_gossip_and_quorum_decide_alone_and_spread_nothing():
    world = make_world(rows=2)
    gossip, quorum = GossipMax(world.buffer, value=[4.0, 9.0]), Quorum(world.buffer, threshold=0.0)
    gossip.spread(0.0)
    world.poses.forget([0])
    stored = len(world.buffer)
    decision = gossip.spread(0.2, np.array([0]))
    assert (decision.decided.tolist(), decision.values.tolist()) == ([True], [4.0])
    decision = quorum.spread(0.2, np.array([0]))
    assert (decision.decided.tolist(), decision.values.tolist(), decision.states.tolist()) == (
        [True],
        [0.0],
        [quorum.states.index("True")],
    )
    assert quorum.state_codes[0] == 0  # what it would be is not taken over
    assert len(world.buffer) == stored
    assert not MorphogenesisBarycenter(world.buffer).decide(0.2, np.array([0])).decided[0]
