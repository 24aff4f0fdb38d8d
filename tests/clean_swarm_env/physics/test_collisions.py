"""Collision counts against a naive count over all pairs, and the definitions of sample and event."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clean_swarm_env.physics.collisions import CollisionCounter
from tests.clean_swarm_env.physics.substeps import count


def close_pairs(positions, width, height, distance):
    """Return the pairs (i, j), i < j, of the rows of one world that are closer than the distance, naively."""
    pairs = set()
    for i in range(len(positions)):
        for j in range(i + 1, len(positions)):
            dx, dy = np.abs(positions[i] - positions[j])
            dx, dy = min(dx, width - dx), min(dy, height - dy)
            if np.hypot(dx, dy) < distance:
                pairs.add((i, j))
    return pairs


def naive_counts(walk, width, height, distances):
    """Samples (K,), events (K,) over a walk (T, N, 2), and contact (N,) and entries (N,) of its last count."""
    robots = walk.shape[1]
    samples, events = np.zeros(len(distances), int), np.zeros(len(distances), int)
    for k, distance in enumerate(distances):
        before = set()
        for positions in walk:
            now = close_pairs(positions, width, height, distance)
            samples[k] += len(now)
            events[k] += len(now - before)
            if k == 0:
                contact = [any(i in pair for pair in now) for i in range(robots)]
                entered = [sum(i in pair for pair in now - before) for i in range(robots)]
            before = now
    return samples, events, contact, entered


def check_counts(counter, walk, width, height, distances):
    """Count a walk (T, N, 2) and compare with the naive count; return the numbers of the counts that listed pairs."""
    lists = set()
    for positions in walk:
        count(counter, positions)
        lists.add(int(counter.packed.record.listed[0]))
    samples, events, contact, entered = naive_counts(walk, width, height, distances)
    assert counter.samples[0].tolist() == samples.tolist()
    assert counter.events[0].tolist() == events.tolist()
    assert counter.in_contact.tolist() == contact
    assert counter.entered.tolist() == entered
    return lists


def random_walk(rng, counts, robots, width, height):
    """Positions (T, N, 2) of robots that wander about the torus."""
    start = rng.uniform(0, (width, height), (robots, 2))
    steps = rng.normal(0, 0.3, (counts, robots, 2))
    return (start + np.cumsum(steps, axis=0)) % (width, height)


@settings(max_examples=40)
@given(st.integers(0, 2**32), st.integers(1, 12), st.sampled_from([(3.0, 3.0), (2.5, 7.0), (11.0, 11.0)]))
def test_small_worlds_against_the_naive_count(seed, robots, size):
    walk = random_walk(np.random.default_rng(seed), 12, robots, *size)
    counter = CollisionCounter(1, robots, *size)
    check_counts(counter, walk, *size, (0.5, 1.0))


@pytest.mark.parametrize(("robots", "size"), [(60, (8.0, 8.0)), (60, (6.2, 20.0)), (120, (12.0, 9.0))])
def test_cells_against_the_naive_count(robots, size):
    walk = random_walk(np.random.default_rng(robots), 4, robots, *size)
    walk[0, 0] = 0.0  # the corner itself, and the last place before it
    walk[0, 1] = np.nextafter(size, 0.0)
    counter = CollisionCounter(1, robots, *size, distances=(1.0, 0.25, 0.5))
    assert counter.packed.record.cells.size > 1
    check_counts(counter, walk, *size, (1.0, 0.25, 0.5))
    assert counter.samples.min() > 0


@pytest.mark.parametrize(
    ("robots", "size", "counts"), [(80, 14.0, 40), (150, 6.5, 10)], ids=["listed", "more pairs than the list holds"]
)
def test_pairs_listed_before_against_the_naive_count(robots, size, counts):
    rng = np.random.default_rng(robots)
    steps = rng.normal(0.0, 0.06, (counts, robots, 2))
    walk = (rng.uniform(0.0, size, (robots, 2)) + np.cumsum(steps, axis=0)) % size
    counter = CollisionCounter(1, robots, size, size, distances=(0.3, 1.0))
    lists = check_counts(counter, walk, size, size, (0.3, 1.0))
    assert (lists == {-1}) if size < 7.0 else (1 < len(lists) < len(walk))  # a list holds for some counts


def test_who_comes_or_goes_is_counted_at_once_in_a_large_world():
    positions = np.stack(np.divmod(np.arange(60), 8), axis=1) * 1.6 + 0.5
    positions[7] = positions[3] + 0.1
    counter, present = CollisionCounter(1, 60, 12.8, 12.8, distances=(0.5,)), np.ones(60, np.bool_)
    seen = []
    for there in (False, True, True, False, True):
        present[7] = there
        count(counter, positions, present)
        seen.append((int(counter.samples[0, 0]), int(counter.events[0, 0])))
    assert seen == [(0, 0), (1, 1), (2, 1), (2, 1), (3, 2)]


@pytest.mark.parametrize("robots", [4, 55])
def test_worlds_of_a_batch_count_as_they_do_alone(robots):
    rng = np.random.default_rng(5)
    walks = np.stack([random_walk(rng, 6, robots, 6.0, 6.0) for _ in range(3)], axis=1)  # (T, W, N, 2)
    batch, alone = CollisionCounter(3, robots, 6.0, 6.0), CollisionCounter(1, robots, 6.0, 6.0)
    for positions in walks:
        count(batch, positions.reshape(-1, 2))
        count(alone, positions[1])
    assert batch.samples[1].tolist() == alone.samples[0].tolist()
    assert batch.events[1].tolist() == alone.events[0].tolist()
    assert batch.in_contact[robots : 2 * robots].tolist() == alone.in_contact.tolist()
    assert batch.entered[robots : 2 * robots].tolist() == alone.entered.tolist()


def test_a_meeting_is_one_event_and_as_many_samples_as_counts():
    counter = CollisionCounter(1, 2, 11.0, 11.0, distances=(0.5,))
    seen = []
    for x in (0.3, 0.2, 0.1, 0.3, 0.2):  # the other stands at -0.25, across the seam
        count(counter, np.array([[x, 5.0], [10.75, 5.0]]))
        seen.append((int(counter.samples[0, 0]), int(counter.events[0, 0]), bool(counter.in_contact[1])))
    assert seen == [(0, 0, False), (1, 1, True), (2, 1, True), (2, 1, False), (3, 2, True)]
    assert counter.entered.tolist() == [1, 1]


def test_a_pair_at_the_distance_itself_is_not_closer():
    counter = CollisionCounter(1, 2, 11.0, 11.0, distances=(0.5, 1.0))
    count(counter, np.array([[1.0, 1.0], [1.5, 1.0]]))
    assert (counter.samples.tolist(), counter.events.tolist()) == ([[0, 1]], [[0, 1]])
    assert not counter.in_contact.any()
    assert counter.entered.tolist() == [0, 0]
    count(counter, np.array([[1.0, 1.0], [1.25, 1.0]]))  # it was not closer before, so this is the event
    assert (counter.samples.tolist(), counter.events.tolist()) == ([[1, 2]], [[1, 1]])
    assert counter.entered.tolist() == [1, 1]


def test_reset_forgets_one_world_only_and_makes_the_next_count_a_first_one():
    counter = CollisionCounter(2, 2, 11.0, 11.0)
    close = np.array([[1.0, 1.0], [1.2, 1.0]] * 2)
    count(counter, close)
    counter.reset(0)
    assert not counter.in_contact[:2].any()
    assert counter.in_contact[2:].all()
    count(counter, close)
    assert counter.samples.tolist() == [[1, 1], [2, 2]]
    assert counter.events.tolist() == [[1, 1], [1, 1]]
    assert counter.entered.tolist() == [1, 1, 0, 0]
