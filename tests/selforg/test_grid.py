"""Cells of a grid: whatever lies within a distance of a place lies in one of the cells that are given for it."""

import numpy as np
import pytest

from selforg.grid import CELL_COLUMNS, MOST_CELLS, axis_cells, bucket_of, cell_of, near_cells
from selforg.space import Euclidean, Torus


@pytest.mark.parametrize("space", [Torus(11.0, 7.0), Euclidean(3)])
@pytest.mark.parametrize("radius", [0.0, 0.4, 2.5])
def test_what_is_near_lies_in_the_cells_around(space, radius):
    rng, cells = np.random.default_rng(1), np.zeros((1, CELL_COLUMNS))
    for axis in range(3):
        flat = axis >= space.dim
        cells[0, 2 * axis : 2 * axis + 2] = (1.0, np.inf) if flat else axis_cells(space.padded_extent[axis], 0.7, 64.0)
    points, window = np.zeros((200, 3)), np.zeros(MOST_CELLS, dtype=np.int64)
    points[:, : space.dim] = rng.random((200, space.dim)) * 6.5
    there = np.array([cell_of(*point, cells, 0) for point in points])
    for place in points[:20]:
        found = near_cells(*place, radius, cells, 0, np.inf, window)
        distances = np.linalg.norm(space.offsets(place[: space.dim], points[:, : space.dim]), axis=1)
        assert set(there[distances <= radius]) <= set(window[:found].tolist())
        assert len(set(window[:found].tolist())) == found


def test_few_members_are_cheaper_one_by_one():
    cells = np.array([[20.0, 0.5, 20.0, 0.5, 1.0, np.inf]])
    window = np.zeros(MOST_CELLS, dtype=np.int64)
    assert near_cells(5.0, 5.0, 0.0, 2.0, cells, 0, 3.0, window) == -1
    assert near_cells(5.0, 5.0, 0.0, 2.0, cells, 0, 1000.0, window) > 3


@pytest.mark.parametrize("extent", [0.0, 10.0])
def test_cells_are_at_least_as_wide_as_asked_for_and_fill_the_axis(extent):
    number, width = axis_cells(extent, 0.7, 1024.0)
    assert width >= 0.7
    assert number * width == pytest.approx(extent if extent else 1024 * 0.7)


def test_neighbouring_cells_of_a_line_share_few_cache_lines_of_buckets():
    buckets = np.zeros(1 << 12, dtype=np.int32)
    lines = {bucket_of(3, cell, buckets) // 16 for cell in range(64)}
    assert len(lines) <= 4
