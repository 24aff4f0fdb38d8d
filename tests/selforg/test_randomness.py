import numpy as np
import pytest

from selforg.randomness import DirectionStream, draw_directions, next_direction


def take(stream, row, count):
    taken = []
    for _ in range(count):
        stream.refill()
        taken.append(next_direction(stream.vectors, stream.cursor, stream.low, row))
    return np.array(taken)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_row_gets_its_generators_directions_in_order(dim):
    stream = DirectionStream([np.random.default_rng(s) for s in (1, 2)], dim, block=8)
    expected = draw_directions(np.random.default_rng(2), 50, dim)
    np.testing.assert_array_equal(take(stream, 1, 50), expected)


def test_rows_take_at_once_what_each_takes_alone():
    stream = DirectionStream([np.random.default_rng(s) for s in (1, 2, 3)], block=8)
    asked = [[2, 0]] * 15 + [[2]] * 15 + [[1, 2]] * 15
    mixed = [stream.next_directions(np.array(rows))[rows.index(2)] for rows in asked]
    np.testing.assert_array_equal(mixed, draw_directions(np.random.default_rng(3), 45, 2))
    steady = DirectionStream.fixed(2)
    np.testing.assert_array_equal(steady.next_directions(np.array([1])), steady.next_directions(np.array([1])))


def test_a_row_does_not_depend_on_another_rows_use():
    alone = take(DirectionStream([np.random.default_rng(5)], block=8), 0, 30)
    stream = DirectionStream([np.random.default_rng(4), np.random.default_rng(5)], block=8)
    mixed = []
    for i in range(30):
        take(stream, 0, i % 3)
        mixed.append(take(stream, 1, 1)[0])
    np.testing.assert_array_equal(mixed, alone)


def test_reset_starts_the_new_generator_from_its_beginning():
    stream = DirectionStream([np.random.default_rng(s) for s in range(3)], block=8)
    untouched = take(DirectionStream([np.random.default_rng(0)], block=8), 0, 9)
    take(stream, 1, 5)
    stream.reset([1], [np.random.default_rng(77)])
    np.testing.assert_array_equal(take(stream, 1, 9), draw_directions(np.random.default_rng(77), 9, 2))
    np.testing.assert_array_equal(take(stream, 0, 9), untouched)


@pytest.mark.parametrize("dim", [2, 3])
def test_directions_are_unit_vectors_without_a_preferred_side(dim):
    drawn = draw_directions(np.random.default_rng(3), 20_000, dim)
    np.testing.assert_allclose(np.linalg.norm(drawn, axis=1), 1.0)
    assert np.abs(drawn.mean(axis=0)).max() < 0.03
    np.testing.assert_allclose((drawn[:, :dim] ** 2).mean(axis=0), 1.0 / dim, atol=0.02)


def test_without_chance_rows_still_differ():
    stream = DirectionStream.fixed(3)
    taken = [next_direction(stream.vectors, stream.cursor, stream.low, row) for row in (0, 1, 2, 0)]
    assert taken[0] == taken[3]
    assert len(set(taken)) == 3
