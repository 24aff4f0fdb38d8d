"""Ways round walls: fields are the shortest ways over the raster, and robots that follow them arrive."""

import heapq

import numpy as np
import pytest

from selforg.compiler.decorators import lean_kernel
from selforg.walls import ways as w
from selforg.walls.free_ground import FreeGround
from selforg.walls.segments import images, is_hidden, packed_walls

SIZE = np.array([6.0, 4.0])
CUP = np.array([[2.0, 1.0, 4.0, 1.0], [4.0, 1.0, 4.0, 3.0], [4.0, 3.0, 2.0, 3.0]])  # open to the left


def ways_among(segments, closed=False):
    around = np.array([[0.0, 0.0, 6.0, 0.0], [6.0, 0.0, 6.0, 4.0], [6.0, 4.0, 0.0, 4.0], [0.0, 4.0, 0.0, 0.0]])
    whole = images(segments, SIZE) if closed else np.concatenate([segments, around])
    return w.Ways(FreeGround.among(whole, (), np.zeros(2), SIZE, 0.25, closed), closed), whole


def field_of(ways, line, column):
    """Return the field of a square by Dijkstra's algorithm in plain Python."""
    lines, columns = ways.room.shape
    field, waiting = np.full(ways.room.shape, w.UNREACHED), [(0, line, column)]
    while waiting:
        length, line, column = heapq.heappop(waiting)
        if field[line, column] != w.UNREACHED:
            continue
        field[line, column] = length
        for down in (-1, 0, 1):
            for right in (-1, 0, 1):
                i, j = line + down, column + right
                if ways.extent[0]:
                    i, j = i % lines, j % columns
                if 0 <= i < lines and 0 <= j < columns and ways.room[i, j] and field[i, j] == w.UNREACHED:
                    step = w.DIAGONAL_STEP if down and right else w.STRAIGHT_STEP
                    heapq.heappush(waiting, (length + (w.TIGHT * step if ways.room[i, j] <= w.TIGHT else step), i, j))
    return field


@lean_kernel
def step_to(x, y, tx, ty, field, room, pitch, extent):
    dx, dy, straight = w.to_target(x, y, tx, ty, extent, room, pitch)
    return (dx, dy) if straight else w.way_down(x, y, field, room, pitch, extent)


@pytest.mark.parametrize("closed", [False, True])
def test_a_field_is_the_shortest_way_of_all_squares(closed):
    ways, _ = ways_among(CUP, closed)
    line, column = np.argwhere(ways.room > w.TIGHT)[700]
    ways.add(line, column)
    assert np.array_equal(ways.fields[ways.numbers[line, column]], field_of(ways, line, column))


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("start", [(3.7, 2.0), (3.7, 1.26), (5.5, 3.5)])
def test_a_robot_that_follows_a_field_arrives_and_keeps_off_walls(closed, start):
    ways, whole = ways_among(CUP, closed)
    walls = packed_walls(whole, (0.0, 0.0), SIZE)
    place, target = np.array(start), np.array([5.5, 2.0])
    line, column = (target / ways.pitch[::1]).astype(int)[::-1]
    ways.add(line, column)
    for _ in range(300):
        way = np.array(step_to(*place, *target, ways.fields[0], ways.room, ways.pitch, ways.extent))
        length = np.linalg.norm(way)
        step = way * min(0.05 / length, 1.0)
        assert not crossing(*place, *step, ways.extent, walls.handle)
        place = (place + step) % SIZE
        if length < 0.1:
            break
    assert np.abs(place - target).max() < 0.1


@lean_kernel
def crossing(x, y, dx, dy, extent, walls):
    return is_hidden(x, y, dx, dy, extent, walls)


@pytest.mark.parametrize("length", [0.5, 5.0])
def test_walls_between_places_are_those_that_the_line_meets(length):
    rng = np.random.default_rng(3)
    segments = rng.uniform(size=(12, 4)) * np.tile(SIZE, 2)
    walls, met = packed_walls(segments, (0.0, 0.0), SIZE), 0
    for _ in range(400):
        start = rng.uniform(size=2) * SIZE
        way = rng.uniform(-length, length, 2)
        expected = False
        for ax, ay, bx, by in segments:
            matrix = np.array([way, [ax - bx, ay - by]]).T
            share = np.linalg.solve(matrix, np.array([ax, ay]) - start)
            expected |= bool(((share >= 0.0) & (share <= 1.0)).all())
        assert crossing(*start, *way, np.zeros(2), walls.handle) == expected
        met += expected
    assert 40 < met < 390


def test_walls_between_places_are_found_far_across_the_seams_of_a_torus():
    rng = np.random.default_rng(4)
    segments, met = rng.uniform(size=(3, 4)) * np.tile(SIZE, 2), 0
    walls = packed_walls(images(segments, SIZE), (0.0, 0.0), SIZE)
    every = packed_walls(images(segments, SIZE, 9.0), (-9.0, -9.0), SIZE + 9.0)
    for _ in range(400):
        start, way = rng.uniform(size=2) * SIZE, rng.uniform(-0.5, 0.5, 2) * SIZE
        found = crossing(*start, *way, SIZE, walls.handle)
        assert found == crossing(*start, *way, np.zeros(2), every.handle)
        met += found
    assert 40 < met < 390


def test_the_oldest_field_makes_room_and_is_the_same_when_it_comes_back(monkeypatch):
    monkeypatch.setattr(w, "MOST_FIELD_BYTES", 1)
    ways, _ = ways_among(CUP)
    squares = np.argwhere(ways.room > w.TIGHT)[:: len(np.argwhere(ways.room > w.TIGHT)) // 9][:9].tolist()
    ways.add(*squares[0])
    first = ways.fields[0].copy()
    for square in squares[1:]:
        ways.add(*square)
    assert len(ways.fields) == 8
    assert ways.numbers[tuple(squares[0])] == w.NO_FIELD
    ways.add(*squares[0])
    assert np.array_equal(ways.fields[ways.numbers[tuple(squares[0])]], first)
    assert (ways.numbers != w.NO_FIELD).sum() == 8
