"""The canvas: places at a seam, the trail and moments between two."""

from dataclasses import replace

import numpy as np
import pytest

from clean_swarm_env.drawing.canvas import Canvas, appearances, between, trail_strength


def canvas(**changes):
    given = {"positions": np.array([[5.0, 5.0], [0.1, 3.0]]), "headings": np.zeros(2)}
    return Canvas(**(given | changes))


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ((5.0, 5.0), {(5.0, 5.0)}),
        ((0.1, 5.0), {(0.1, 5.0), (11.1, 5.0)}),
        ((5.0, 10.9), {(5.0, 10.9), (5.0, -0.1)}),
        ((0.1, 10.9), {(0.1, 10.9), (11.1, 10.9), (0.1, -0.1), (11.1, -0.1)}),
        ((0.3, 5.0), {(0.3, 5.0)}),
    ],
)
def test_what_lies_on_a_seam_shows_on_both_sides(place, expected):
    found = {(round(x, 9), round(y, 9)) for x, y in appearances(canvas(), np.array([place]), 0.25)[1]}
    assert found == expected


def test_the_trail_is_the_strongest_pheromone_at_the_shorter_way():
    rng = np.random.default_rng(1)
    drawn = canvas(
        pheromones=rng.uniform(0, (11, 7), (30, 2)), pheromone_diffusions=rng.uniform(0.2, 1.5, 30), height=7.0
    )
    raster = trail_strength(drawn)
    assert raster.shape == (70, 110)
    for line, column in rng.integers(0, raster.shape, (200, 2)):
        offsets = np.abs(np.array([column + 0.5, line + 0.5]) * 0.1 - drawn.pheromones)
        distances = np.hypot(*np.minimum(offsets, (11.0, 7.0) - offsets).T)
        strongest = max(0.0, float((drawn.pheromone_diffusions - distances).max() / drawn.pheromone_diffusions.max()))
        assert raster[line, column] == pytest.approx(strongest, abs=1e-9)


def test_a_pheromone_wider_than_the_world_still_has_its_centre():
    raster = trail_strength(
        canvas(width=2.0, height=2.0, pheromones=np.array([[0.55, 1.05]]), pheromone_diffusions=np.array([9.0]))
    )
    assert np.unravel_index(raster.argmax(), raster.shape) == (10, 5)
    assert raster.max() == pytest.approx(1.0)


def test_robots_move_the_shorter_way_between_two_moments_and_never_jump():
    first = canvas(positions=np.array([[10.9, 5.0], [3.0, 3.0]]), headings=np.array([3.0, 0.0]), time=1.0)
    second = replace(first, positions=np.array([[0.1, 5.0], [9.0, 9.0]]), headings=np.array([-3.0, 0.0]), time=1.2)
    middle = between(first, second, 0.75)
    assert middle.positions == pytest.approx(np.array([[0.05, 5.0], [3.0, 3.0]]))
    assert middle.headings[0] == pytest.approx(3.0 + 0.75 * (2.0 * np.pi - 6.0))
    assert middle.time == pytest.approx(1.15)
    fewer = replace(second, positions=second.positions[:1], headings=second.headings[:1])
    assert between(first, fewer, 0.5) is first
