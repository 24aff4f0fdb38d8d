"""Mechanisms see walls: repulsions lead away, walks turn back, steering keeps off; far walls change nothing."""

import numpy as np
import pytest

from selforg.commands import Commands
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import MOST_WALLS, OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import ORCA, Exploration, Patrol, PredictiveSteering, RepulsionFernandez, RepulsionGradient
from selforg.mechanisms.steering.orca import WALL_HORIZON
from selforg.space import Torus
from selforg.walls.segments import images, packed_walls

SIZE = np.array([9.0, 9.0])
CORNER = np.array([[4.0, 2.0, 4.0, 5.0], [4.0, 5.0, 1.0, 5.0]])


def poses_at(*places, walls=CORNER, heading=0.0, towards=(1.0, 0.0)):
    """Poses of robots that have driven at 1 m/s to their places among walls."""
    packed = None if walls is None else packed_walls(images(walls, SIZE), (0.0, 0.0), SIZE)
    poses = OwnPoses(Torus(*SIZE), len(places), walls=packed)
    for now in (0.0, 0.2):
        poses.update(np.array(places) - (0.2 - now) * np.array(towards), np.full(len(places), heading), now)
    return poses


def test_the_nearest_points_of_walls_are_known_each_once():
    poses = poses_at((3.5, 4.5), (4.5, 5.5), (8.0, 8.0), (3.5, 2.9))
    record = poses.packed.record
    assert record.wall_counts.tolist() == [2, 1, 0, 1]  # (3.5, 2.9) is over two metres from the upper wall
    assert np.allclose(record.wall_ways[0, :2], [[0.5, 0.0], [0.0, 0.5]])
    assert np.allclose(record.wall_ways[1, 0], [-0.5, -0.5])  # the corner, where both meet


def test_of_many_walls_the_nearest_are_known():
    rng = np.random.default_rng(1)
    ends = rng.uniform(1.0, 4.0, (40, 2))
    poses = poses_at((2.5, 2.5), walls=np.hstack([ends, ends + 0.01]))
    distances = np.sort(np.linalg.norm(poses.packed.record.wall_ways[0], axis=1))
    assert poses.packed.record.wall_counts[0] == MOST_WALLS
    assert np.abs(distances - np.sort(np.linalg.norm(ends - 2.5, axis=1))[:MOST_WALLS]).max() < 0.02


@pytest.mark.parametrize("kind", [RepulsionGradient, RepulsionFernandez])
def test_repulsion_leads_away_from_walls_the_more_the_nearer_they_are(kind):
    poses = poses_at((3.6, 3.0), (3.5, 3.4), (3.75, 2.2), (3.3, 2.6), (3.7, 4.7))
    alone = OwnPoses(Torus(*SIZE), 5, np.arange(5), walls=poses._walls)
    alone.update(poses.positions, np.zeros(5), 0.0)
    vectors, active = kind(alone, view_distance=0.1).move(0.0)
    assert active.tolist() == [True, True, True, False, True]
    assert np.allclose(vectors[:3, 1], 0.0)
    assert np.allclose(vectors[:3, 0], [-1.0, -0.5, -1.5])
    assert np.allclose(vectors[4], -1.5 / np.sqrt(2.0))  # both walls, limited to the own reach


@pytest.mark.parametrize("kind", [Exploration, Patrol])
def test_walks_turn_back_before_walls(kind):
    poses = poses_at(*[(3.7, 4.7)] * 40)
    mechanism = kind(SoBuffer(BufferSettings(), poses.space, poses), channels=("none",))
    if kind is Patrol:
        mechanism.buffer.store_static(0, "none", np.array([[3.5, 4.6]]), 0.0, attraction=-1)
    vectors, active = mechanism.move(0.2)
    assert active.all()
    assert (vectors <= 1e-12).all()
    assert (np.linalg.norm(vectors, axis=1) > 0.09).all()


@pytest.mark.parametrize(("kind", "least"), [(ORCA, 0.3), (PredictiveSteering, 0.25)])
@pytest.mark.parametrize("place", [(2.0, 3.0), (3.0, 4.0)])
def test_steering_robots_keep_off_a_wall_that_they_are_told_to_drive_into(kind, least, place):
    place, velocity = np.array(place), np.array([1.0, 0.5])
    for _ in range(40):
        poses = poses_at(place, heading=np.arctan2(*velocity[::-1]), towards=velocity)
        commands = Commands(1, 2)
        commands.vectors[:], commands.commanded[:] = (1.0, 0.5), True
        kind(poses, view_distance=1.0).steer(0.2, np.array([0]), commands.packed.handle)
        velocity = commands.vectors[0].copy()
        place = place + 0.2 * velocity
        assert place[0] < 4.0 - least
        assert place[1] < 5.0 - least


def test_orca_nears_walls_by_what_is_left_in_its_horizon_from_the_first_pose_on():
    poses = OwnPoses(Torus(*SIZE), 2, walls=packed_walls(images(CORNER, SIZE), (0.0, 0.0), SIZE))
    poses.update(np.array([[3.4, 3.0], [2.5, 4.4]]), np.zeros(2), 0.0)
    commands = Commands(2, 2)
    commands.vectors[:], commands.commanded[:] = np.eye(2), True
    ORCA(poses, view_distance=1.0, distance=0.8).steer(0.0, np.arange(2), commands.packed.handle)
    assert np.allclose(np.diag(commands.vectors), (0.6 - 0.5 * 0.8) / WALL_HORIZON)


@pytest.mark.parametrize("kind", [ORCA, PredictiveSteering, RepulsionGradient])
def test_far_walls_change_no_bit(kind):
    answers = []
    for walls in (None, CORNER):
        poses, commands = poses_at((7.0, 7.0), (7.6, 7.1), walls=walls), Commands(2, 2)
        commands.vectors[:], commands.commanded[:] = (1.0, 0.2), True
        mechanism = kind(poses, view_distance=1.0)
        if kind is RepulsionGradient:
            answers.append(mechanism.move(0.2)[0])
        else:
            mechanism.steer(0.2, np.arange(2), commands.packed.handle)
            answers.append(commands.vectors.copy())
    assert np.array_equal(*answers)
    assert np.abs(answers[0]).max() > 0.0
