import numpy as np
import pytest
from numpy.testing import assert_allclose

from clean_swarm_env.tasks.measures.agreement import connected, in_earshot, rounds_by_calls, rounds_needed
from clean_swarm_env.tasks.measures.coverage import UNSEEN, area, idleness, mark
from clean_swarm_env.tasks.measures.field import Field, height
from clean_swarm_env.tasks.measures.order import (
    barycentre,
    gap_spread,
    nearest_neighbours,
    polarisation,
    radial_spread,
    unevenness,
)
from clean_swarm_env.world.ground import Ground

TORUS = Ground("torus", np.full(2, 10.0), np.full(2, 10.0))
OPEN = Ground("open", np.full(2, 10.0), np.full(2, 24.0))


def ring(count, radius, centre=(5.0, 5.0)):
    angles = np.arange(count) * 2.0 * np.pi / count
    return (np.array(centre) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1))[None]


@pytest.mark.parametrize("closed", [True, False])
def test_coverage_is_that_of_a_naive_search_of_all_cells(closed):
    rng = np.random.default_rng(3)
    maps, seen = np.array([0, 0, 1]), np.full((2, 20, 20), UNSEEN)
    middles = np.stack(np.meshgrid(*2 * [np.arange(20) * 0.5 + 0.25], indexing="xy"), axis=-1)
    expected = seen.copy()
    for now in (1.0, 2.0, 3.0):
        positions = rng.uniform(0.0, 10.0, size=(3, 2))
        mark(positions, maps, np.full(3, now), np.zeros(2), 1.3, 0.5, closed, seen)
        for row, place in enumerate(positions):
            away = np.abs(middles - place)
            away = np.minimum(away, 10.0 - away) if closed else away
            expected[row // 2][np.hypot(*np.moveaxis(away, -1, 0)) <= 1.3] = now
    assert_allclose(seen, expected)
    assert_allclose(area(seen, 0.5), (expected > UNSEEN).sum(axis=(1, 2)) * 0.25)


def test_idleness_grows_where_nobody_looks():
    seen = np.full((1, 2, 2), UNSEEN)
    mark(np.array([[0.5, 0.5]]), np.array([0]), np.array([8.0]), np.zeros(2), 0.2, 1.0, True, seen)
    assert_allclose(idleness(seen, np.array([10.0])), (2.0 + 3 * 10.0) / 4)


def test_polarisation_of_equal_opposite_and_random_headings():
    rng = np.random.default_rng(1)
    assert_allclose(polarisation(np.array([[0.3, 0.3], [0.0, np.pi]])), [1.0, 0.0], atol=1e-12)
    by_chance = polarisation(rng.uniform(-np.pi, np.pi, size=(4000, 12))).mean()
    assert by_chance == pytest.approx(np.sqrt(np.pi / 4 / 12), rel=0.05)


def test_nearest_neighbours_across_the_seam_and_in_the_open():
    positions = np.array([[[0.5, 5.0], [9.5, 5.0], [5.0, 5.0]]])
    assert_allclose(nearest_neighbours(positions, TORUS), [[1.0, 1.0, 4.5]])
    assert_allclose(nearest_neighbours(positions, OPEN), [[4.5, 4.5, 4.5]])
    assert np.isinf(nearest_neighbours(positions[:, :1], OPEN)).all()


def test_unevenness_of_a_lattice_and_of_random_places():
    lattice = np.stack(np.meshgrid(np.arange(5) * 2.0, np.arange(5) * 2.0), axis=-1).reshape(1, 25, 2)
    assert_allclose(unevenness(lattice, TORUS), 0.0, atol=1e-12)
    places = np.random.default_rng(2).uniform(0.0, 10.0, size=(400, 25, 2))
    assert unevenness(places, TORUS).mean() == pytest.approx(0.52, abs=0.03)


def test_a_ring_has_no_spread():
    assert_allclose(radial_spread(ring(7, 3.0), np.array([5.0, 5.0]), OPEN), 0.0, atol=1e-12)
    assert_allclose(gap_spread(ring(7, 3.0), np.array([5.0, 5.0]), OPEN), 0.0, atol=1e-12)
    two = np.array([[[6.0, 5.0], [8.0, 5.0]]])
    assert_allclose(radial_spread(two, np.array([[5.0, 5.0]]), OPEN), 1.0)
    assert_allclose(gap_spread(two, np.array([[5.0, 5.0]]), OPEN), np.pi)


def test_barycentre_in_the_open_and_across_the_seam():
    assert_allclose(barycentre(ring(5, 2.0), OPEN), [[5.0, 5.0]])
    assert_allclose(barycentre(ring(5, 2.0, (0.0, 5.0)) % 10.0, TORUS) % 10.0, [[0.0, 5.0]], atol=1e-9)


def test_height_is_the_integral_of_the_forces():
    field = Field(np.array([[[0.0, 0.0], [3.0, 0.0]]]), np.array([1.0, -1.0]), np.array([4.0, 2.0]), np.array([0.5, 0]))

    def at(x):
        return height(field, np.array([[[x, 0.0]]]), 0.25, OPEN)[0, 0]

    for x in (1.5, 2.0, 4.0, 4.6, 6.0):
        clearance, hill = abs(x) - 0.75, abs(x - 3.0) - 0.25
        pull = min(clearance / 4.0, 1.0)
        push = max((2.0 - hill) / 2.0, 0.0) * np.sign(x - 3.0)
        slope = (at(x + 1e-5) - at(x - 1e-5)) / 2e-5
        assert slope == pytest.approx(push - pull, abs=1e-4)
    assert at(0.3) == 0.0  # inside the goal area, out of reach of the hill


def test_rounds_on_a_line_of_robots():
    line = np.stack([np.arange(5) * 1.0, np.zeros(5)], axis=1)[None]
    hears = in_earshot(line, 1.1, OPEN)[0]
    assert connected(hears)
    assert not connected(in_earshot(line, 0.9, OPEN)[0])
    assert [rounds_needed(hears, first) for first in range(5)] == [4, 3, 2, 3, 4]
    values = np.arange(5.0)
    rounds = [rounds_by_calls(hears, values, np.random.default_rng(seed), 1000) for seed in range(50)]
    assert min(rounds) >= 4
    assert np.mean(rounds) > 5  # asking the wrong neighbour half of the time


def test_open_land_is_never_left():
    assert_allclose(OPEN.centre, [12.0, 12.0])
    assert_allclose(OPEN.corner, [7.0, 7.0])
    assert_allclose(OPEN.offsets(np.array([1.0, 1.0]), np.array([23.0, 1.0])), [22.0, 0.0])
    assert_allclose(TORUS.distances(np.array([1.0, 1.0]), np.array([9.0, 1.0])), 2.0)
