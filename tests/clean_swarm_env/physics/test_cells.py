"""The nearest point by cells against a look at all points."""

import numpy as np
import pytest

from clean_swarm_env.physics.cells import FEW, NOBODY, cells_along, fill_cells, nearest_point


@pytest.mark.parametrize(("points", "reach"), [(200, 1.0), (200, 2.9), (FEW, 1.0)], ids=["cells", "wide", "none"])
def test_the_nearest_point_is_found_by_cells_and_without(points, reach):
    rng, extent = np.random.default_rng(points), np.array([11.0, 9.0])
    places, there = rng.random((points, 2)) * extent, rng.random(points) < 0.7
    places[0], places[1] = 0.0, np.nextafter(extent, 0.0)  # the corner itself, and the last place before it
    cells, links = np.empty(cells_along(points, reach, extent), np.int64), np.empty(points, np.int64)
    assert (cells.size > 0) == (points > FEW)
    fill_cells(places, 0, there, extent, cells, links)
    for x, y in [*(rng.random((50, 2)) * extent), (0.0, 0.0), (10.99, 8.99)]:
        offsets = np.abs(places - [x, y])
        lengths = np.where(there, np.hypot(*np.minimum(offsets, extent - offsets).T), np.inf)
        found, length = nearest_point(x, y, reach, places, there, extent, cells, links)
        if lengths.min() > reach:
            assert (found, length) == (NOBODY, np.inf)
        else:
            assert (found, length) == (lengths.argmin(), pytest.approx(lengths.min()))


def test_of_two_points_equally_near_the_first_one_is_found():
    places, there, extent = np.tile([[5.0, 5.0], [6.0, 5.0]], (30, 1)), np.ones(60, np.bool_), np.array([11.0, 11.0])
    cells, links = np.empty(cells_along(60, 1.0, extent), np.int64), np.empty(60, np.int64)
    fill_cells(places, 0, there, extent, cells, links)
    assert nearest_point(5.5, 5.0, 1.0, places, there, extent, cells, links) == (0, 0.5)


def test_without_points_none_is_found():
    nowhere, extent = np.empty((0, 2)), np.array([11.0, 11.0])
    cells, links = np.empty(cells_along(0, 1.0, extent), np.int64), np.empty(0, np.int64)
    assert nearest_point(5.0, 5.0, 1.0, nowhere, np.empty(0, np.bool_), extent, cells, links) == (NOBODY, np.inf)
