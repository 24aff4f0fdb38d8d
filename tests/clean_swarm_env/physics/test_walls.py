"""Walls stop bodies: on a torus also across its seams, the same bits by both ways to pymunk, alone and in a batch."""

import numpy as np
import pytest

from clean_swarm_env.physics.contact_space import chipmunk_functions
from clean_swarm_env.physics.physics import Physics, PhysicsSettings
from selforg.walls.segments import distances_to, images, packed_walls
from tests.clean_swarm_env.physics.substeps import substep
from tests.clean_swarm_env.physics.test_physics import drive_about

EXTENT = np.array([6.0, 6.0])
CROSS = np.array([[1.0, 3.0, 5.0, 3.0], [3.0, 1.0, 3.0, 5.0], [5.95, 1.0, 5.95, 5.0]])


def among(walls, worlds=1, robots=1, seed=0, **settings):
    """Return worlds of robots at random places among `walls` (K, 4)."""
    whole = images(np.asarray(walls, dtype=float).reshape(-1, 4), EXTENT)
    physics = Physics(PhysicsSettings(worlds, robots, *EXTENT, **settings), packed_walls(whole, (0.0, 0.0), EXTENT))
    for world in range(worlds):
        rng, places = np.random.default_rng((seed, world)), []
        while len(places) < robots:
            place = rng.uniform(size=2) * EXTENT
            if distances_to(whole, place).min(initial=np.inf) > 0.3:
                places.append(place)
        physics.place(world, np.array(places), rng.uniform(-3, 3, robots))
    return physics, whole


@pytest.mark.parametrize(("start", "wall"), [((4.0, 3.0), 5.0), ((4.0, 3.0), 5.95), ((0.5, 3.0), 0.0)])
@pytest.mark.parametrize("contacts", ["solid", "pass_through"])
def test_a_robot_stops_at_a_wall_and_slides_along_it(start, wall, contacts):
    physics, _ = among([[wall, 1.0, wall, 5.0]], contacts=contacts)
    towards = 0.0 if wall > start[0] else np.pi
    physics.place(0, np.array([start]), np.array([towards]))
    for _ in range(80):
        substep(physics, np.ones(1), np.zeros(1))
    assert abs(physics.positions[0, 0] - wall) == pytest.approx(0.25, abs=0.006)
    assert physics.positions[0, 1] == pytest.approx(3.0, abs=1e-6)
    physics.headings[:] = towards + 0.5 * np.pi + (0.3 if towards == np.pi else -0.3)
    for _ in range(20):
        substep(physics, np.ones(1), np.zeros(1))
    assert abs(physics.positions[0, 1] - 3.0) == pytest.approx(np.cos(0.3), abs=0.02)


def test_a_robot_stops_at_a_wall_beyond_the_seam():
    physics, _ = among([[0.1, 1.0, 0.1, 5.0]])
    physics.place(0, np.array([[5.0, 3.0]]), np.zeros(1))
    for _ in range(80):
        substep(physics, np.ones(1), np.zeros(1))
    assert physics.positions[0, 0] == pytest.approx(5.85, abs=0.006)


@pytest.mark.parametrize("contacts", ["solid", "pass_through"])
def test_no_robot_of_a_crowd_gets_through_and_the_least_distance_is_little_less_than_its_radius(contacts):
    physics, whole = among(CROSS, worlds=2, robots=8, contacts=contacts)
    course = drive_about(physics, 150, 1)[..., :2].reshape(-1, 2)
    apart = np.array([distances_to(whole, place).min() for place in course])
    assert 0.2 < apart.min() < 0.26


def test_both_ways_to_pymunk_give_the_same_bits_among_walls(monkeypatch):
    courses = []
    for functions in (chipmunk_functions(), chipmunk_functions(called=False)):
        monkeypatch.setattr("clean_swarm_env.physics.physics.FUNCTIONS", functions)
        physics, _ = among(CROSS, worlds=2, robots=8)
        physics.remove(3)
        courses.append(drive_about(physics, 40, 1))
    assert np.array_equal(*courses)


def test_a_world_has_the_same_bits_alone_and_in_a_batch_and_no_address_is_left_between_ticks():
    alone, batch = among(CROSS, robots=8)[0], among(CROSS, worlds=3, robots=8)[0]
    commands = np.random.default_rng(3).uniform(-1.0, 1.0, (60, 24, 2))
    touched = False
    for speed, turn in zip(np.abs(commands[..., 0]), 2.0 * commands[..., 1], strict=True):
        substep(alone, speed[:8], turn[:8])
        substep(batch, speed, turn)
        assert np.array_equal(alone.bodies, batch.bodies[:8])
        touched |= bool(alone.motion.record.patience[0])
        assert not batch.motion.record.walls.any()
    assert touched


def test_walls_far_from_all_robots_change_no_bit():
    free, far = among([], robots=4)[0], among([[2.9, 2.9, 3.1, 3.1]], robots=4)[0]
    for physics in (free, far):
        physics.place(0, np.array([[0.3, 0.3], [0.9, 0.3], [0.3, 0.9], [0.9, 0.9]]), np.zeros(4))
    for _ in range(12):
        for physics in (free, far):
            substep(physics, np.full(4, 0.5), np.array([1.0, 3.0, -1.0, 2.0]))
        assert np.array_equal(free.bodies, far.bodies)
