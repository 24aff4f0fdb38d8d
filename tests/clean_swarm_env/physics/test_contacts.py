"""Contacts: the course that pymunk gives, in an order that depends on the rows only, from nothing but arrays."""

import math

import numpy as np
import pymunk
import pytest

from clean_swarm_env.physics.contacts import CONTACTS, SKIN, SLOP
from clean_swarm_env.physics.physics import Physics
from clean_swarm_env.physics.settings import PhysicsSettings

SIZE = 20.0


def at_start(starts, **settings):
    """One world with robots at (x, y, heading)."""
    physics = Physics(PhysicsSettings(1, len(starts), SIZE, SIZE, **settings))
    physics.place(0, np.array(starts)[:, :2], np.array(starts)[:, 2])
    return physics


def course_of_pymunk(starts, speeds, substeps):
    """Places (T, N, 2) in pymunk, which moves discs at the beginning of a step, not at its end."""
    space = pymunk.Space()
    space.collision_slop, space.collision_persistence = SLOP, 1  # a contact is remembered until the next step
    discs = []
    for x, y, _ in starts:
        disc = pymunk.Body(1.0, math.inf)
        disc.position = x, y
        space.add(disc, pymunk.Circle(disc, 0.25 * (1.0 + SKIN)))
        discs.append(disc)
    course = []
    for _ in range(substeps):
        for disc, (_, _, heading), speed in zip(discs, starts, speeds, strict=True):
            wanted = pymunk.Vec2d(speed * math.cos(heading), speed * math.sin(heading))
            disc.force = (wanted - disc.velocity) / 0.05
        space.step(0.05)
        course.append([tuple(disc.position) for disc in discs])
    return np.array(course)


def course_of_ours(starts, speeds, substeps):
    physics, course = at_start(starts), []
    for _ in range(substeps):
        course.append(physics.positions.copy())
        physics.substep(np.array(speeds), np.zeros(len(speeds)))
    return np.array(course)


@pytest.mark.parametrize(
    ("starts", "speeds"),
    [
        ([(9.0, 10.0, 0.0), (11.0, 10.0, math.pi)], (1.0, 1.0)),
        ([(9.0, 10.0, 0.0), (11.0, 10.13, math.pi)], (1.0, 0.6)),
        ([(9.0, 10.0, 0.2), (10.0, 10.1, 0.0)], (0.9, 0.0)),
        ([(10.0, 10.0, 0.0), (10.2, 10.1, 0.0)], (0.0, 0.0)),  # overlap at the start
    ],
)
def test_two_robots_take_the_course_that_pymunk_gives(starts, speeds):
    ours, pymunks = course_of_ours(starts, speeds, 120), course_of_pymunk(starts, speeds, 120)
    assert np.linalg.norm(ours[:, 0] - ours[:, 1], axis=1).min() < 0.5
    np.testing.assert_allclose(ours, pymunks, atol=1e-9)


def test_a_row_of_robots_that_pushes_takes_the_course_that_pymunk_gives():
    """Three are solved by iteration, whose order differs: it has not converged in full after ten rounds."""
    starts = [(9.0, 10.0, 0.0), (10.0, 10.1, 0.0), (11.0, 10.0, 0.0)]
    ours, pymunks = (course(starts, (1.0, 0.0, 0.0), 120) for course in (course_of_ours, course_of_pymunk))
    assert ours[-1, 2, 0] > 11.1, "the last one was not pushed"
    np.testing.assert_allclose(ours, pymunks, atol=0.02)


def crowd(robots, width, seed=3):
    physics = Physics(PhysicsSettings(1, robots, width, width))
    rng = np.random.default_rng(seed)
    physics.place(0, rng.uniform(0.0, width, (robots, 2)), rng.uniform(-3.0, 3.0, robots))
    return physics


def walk(physics, substeps, seed=4):
    rng, course = np.random.default_rng(seed), []
    for _ in range(substeps):
        physics.substep(rng.uniform(0.0, 1.0, len(physics.positions)), rng.uniform(-2.0, 2.0, len(physics.positions)))
        course.append(physics.positions.copy())
    return np.array(course)


def test_searching_by_cells_gives_the_same_bits_as_looking_at_all_pairs():
    by_cells, by_pairs = crowd(60, 9.0), crowd(60, 9.0)
    assert by_cells._contacts.record.cells.size > 0
    record = by_pairs._contacts.record._replace(cells=np.zeros((0, 0), np.int64))
    by_pairs._contacts = CONTACTS.pack(record)
    courses = walk(by_cells, 200), walk(by_pairs, 200)
    assert by_cells._contacts.record.touching[0] > 10
    assert np.array_equal(*courses)


def test_whoever_touches_nobody_moves_as_if_the_others_were_not_there():
    alone = at_start([(2.0, 2.0, 0.3), (15.0, 15.0, 0.0), (17.0, 15.0, 0.0)])
    beside = at_start([(2.0, 2.0, 0.3), (15.0, 15.0, 0.0), (15.3, 15.0, math.pi)])
    for _ in range(50):
        for physics in (alone, beside):
            physics.substep(np.full(3, 0.7), np.array([0.5, 0.0, 0.0]))
    assert np.array_equal(alone.positions[0], beside.positions[0])
    assert not np.array_equal(alone.positions[1], beside.positions[1])


def test_a_robot_that_was_taken_away_and_comes_back_brings_no_push_along():
    """It meets its neighbour with no impulse remembered, as at the first touch."""
    physics = at_start([(10.0, 10.0, 0.0), (10.49, 10.0, math.pi), (3.0, 3.0, 0.0)])
    for _ in range(10):
        physics.substep(np.array([1.0, 1.0, 0.0]), np.zeros(3))
    assert physics._contacts.record.impulses[0, 0] > 0.0
    physics.remove(1)
    physics.add(1, 10.49, 10.0, math.pi)
    assert physics._contacts.record.impulses[0, 0] == 0.0


def test_contacts_beyond_the_room_are_left_out_without_harm():
    """All at one place have far more contacts than there is room for: they come apart nevertheless."""
    physics = Physics(PhysicsSettings(1, 60, SIZE, SIZE))
    rng = np.random.default_rng(0)
    physics.place(0, 10.0 + rng.uniform(0.0, 0.1, (60, 2)), np.zeros(60))
    room = physics._contacts.record.pairs.shape[1]
    physics.substep(np.zeros(60), np.zeros(60))
    assert physics._contacts.record.touching[0] == room < 60 * 59 // 2
    walk(physics, 2000)
    assert physics._contacts.record.touching[0] < room / 4
    assert np.isfinite(physics.positions).all()
