"""Walls: cells list what is near, images lie across seams, free ground ends at walls and has no closed rooms."""

import numpy as np
import pytest

from selforg.compiler.decorators import lean_kernel
from selforg.walls.free_ground import FreeGround, inside
from selforg.walls.segments import distances_to, images, packed_walls, touches_wall

SIZE = np.array([7.0, 5.0])
ROOM = np.array([[2.0, 1.0, 5.0, 1.0], [5.0, 1.0, 5.0, 4.0], [5.0, 4.0, 2.0, 4.0], [2.0, 4.0, 2.0, 1.0]])


@lean_kernel
def touching(x, y, radius, walls):
    return touches_wall(x, y, radius, walls)


def ground(segments, radius=0.25, closed=False, solids=()):
    return FreeGround.among(segments, solids, np.zeros(2), SIZE, radius, closed)


@pytest.mark.parametrize("seed", range(5))
def test_cells_find_the_walls_that_all_segments_show_on_the_torus(seed):
    rng = np.random.default_rng(seed)
    whole = images(rng.uniform(size=(9, 4)) * np.tile(SIZE, 2), SIZE)
    walls, found = packed_walls(whole, (0.0, 0.0), SIZE), []
    for point in rng.uniform(size=(300, 2)) * SIZE:
        radius = rng.uniform(0.05, 1.5)
        found.append(touching(*point, radius, walls.handle))
        assert found[-1] == (distances_to(whole, point).min() < radius)
    assert 30 < sum(found) < 290


def test_a_wall_near_a_seam_has_an_image_beyond_the_other_one():
    wall = np.array([[6.9, 1.0, 6.9, 2.0]])
    assert images(wall, SIZE, near=0.5).tolist() == [[6.9, 1.0, 6.9, 2.0], [6.9 - 7.0, 1.0, 6.9 - 7.0, 2.0]]
    assert len(images(np.array([[3.0, 2.0, 4.0, 2.0]]), SIZE, near=0.5)) == 1


def test_a_room_without_a_door_is_found_and_a_door_opens_it():
    closed = ground(ROOM)
    assert np.abs(closed.closed_room() - (3.5, 2.5)).max() < 1.25
    assert not closed.has(np.array([[3.5, 2.5]]))[0]
    for width, passes in ((0.45, False), (0.65, True)):
        door = np.concatenate([ROOM[1:], [[2.0, 1.0, 3.0, 1.0], [3.0 + width, 1.0, 5.0, 1.0]]])
        assert (ground(door).closed_room() is None) is passes


def test_what_is_inside_of_a_closed_wall_is_no_room():
    corners = ROOM[:, :2]
    solid = ground(ROOM, solids=[corners])
    assert solid.closed_room() is None
    assert solid.has(np.array([[1.0, 1.0], [3.5, 2.5], [1.9, 2.0]])).tolist() == [True, False, False]


@pytest.mark.parametrize("seed", range(4))
def test_places_inside_of_a_polygon_are_those_that_a_look_at_each_place_and_edge_finds(seed):
    rng = np.random.default_rng(seed)
    corners = 0.5 * rng.integers(0, 12, (9, 2))  # on places and in their lines, too
    xs, ys = np.arange(0.0, 6.0, 0.25), np.arange(0.0, 5.0, 0.5)
    expected = np.zeros((len(ys), len(xs)), bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        for line, column in np.ndindex(expected.shape):
            x, y = xs[column], ys[line]
            expected[line, column] ^= (ay > y) != (by > y) and x < (y - ay) * (bx - ax) / (by - ay) + ax
    assert np.array_equal(inside(xs, ys, corners), expected)
    assert 20 < expected.sum() < 200


def test_a_wall_across_a_torus_leaves_one_room_two_walls_leave_two():
    across = [[0.0, 1.0, 7.0, 1.0], [0.0, 3.0, 7.0, 3.0]]
    assert ground(images(np.array(across[:1]), SIZE), closed=True).closed_room() is None
    assert ground(images(np.array(across), SIZE), closed=True).closed_room() is not None
    assert ground(np.array(across[:1])).closed_room() is not None  # no torus


def test_the_free_area_is_that_of_the_rectangle_without_a_margin():
    around = np.array([[0.0, 0.0, 7.0, 0.0], [7.0, 0.0, 7.0, 5.0], [7.0, 5.0, 0.0, 5.0], [0.0, 5.0, 0.0, 0.0]])
    assert ground(around).area == pytest.approx(6.5 * 4.5, rel=0.02)
