import numpy as np
import pytest
from scipy import stats

from selector.strategies.streams import normals, philox, row_keys, student_t, uniforms

KEYS = row_keys(np.random.SeedSequence(3), 20_000)


@pytest.mark.parametrize(
    ("counter", "key", "answer"),
    [
        ((0, 0, 0, 0), (0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
        ((2**32 - 1,) * 4, (2**32 - 1,) * 2, (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD)),
        (
            (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
            (0xA4093822, 0x299F31D0),
            (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
        ),
    ],
)
def test_known_answers_of_the_authors(counter, key, answer):
    assert tuple(int(word) for word in philox(*(np.uint64(word) for word in counter + key))) == answer


def test_numbers_depend_on_key_and_decision_only():
    counters = np.arange(10, dtype=np.uint64) % np.uint64(3)
    together = uniforms(KEYS[:10], counters, 5)
    for row in range(10):
        np.testing.assert_array_equal(uniforms(KEYS[row : row + 1], counters[row : row + 1], 5)[0], together[row])
    np.testing.assert_array_equal(uniforms(KEYS[:10], counters, 3), together[:, :3])
    assert len(np.unique(together)) == together.size


def test_the_whole_key_and_the_whole_counter_count():
    keys = np.array([1, 1 + 2**32, 2**32], dtype=np.uint64)
    assert len(np.unique(uniforms(keys, np.zeros(3, np.uint64), 1))) == 3
    assert len(np.unique(uniforms(np.zeros(3, np.uint64), keys, 1))) == 3


def test_keys_of_rows_do_not_depend_on_how_many_there_are():
    np.testing.assert_array_equal(row_keys(np.random.SeedSequence(3), 7), KEYS[:7])
    assert len(np.unique(KEYS)) == len(KEYS)


@pytest.mark.parametrize("along", ["rows", "decisions"])
def test_numbers_are_uniform(along):
    count = len(KEYS)
    if along == "rows":
        drawn = uniforms(KEYS, np.zeros(count, np.uint64), 2)
    else:
        drawn = uniforms(np.full(count, KEYS[0]), np.arange(count, dtype=np.uint64), 2)
    assert drawn.min() >= 0.0
    assert drawn.max() < 1.0
    for column in drawn.T:
        assert stats.kstest(column, "uniform").pvalue > 1e-3
    assert abs(np.corrcoef(drawn.T)[0, 1]) < 5 / np.sqrt(count)


def test_deviates_have_their_distribution():
    draws = uniforms(KEYS, np.zeros(len(KEYS), np.uint64), 6)
    deviates = np.empty((len(KEYS), 3))
    normals(draws, deviates)
    for column in deviates.T:
        assert stats.kstest(column, "norm").pvalue > 1e-3
    freedom = np.tile([1.0, 4.5, 300.0], (len(KEYS), 1))
    student_t(draws, freedom, deviates)
    for column, degrees in zip(deviates.T, freedom[0], strict=True):
        assert stats.kstest(column, stats.t(degrees).cdf).pvalue > 1e-3
    assert np.isfinite(deviates).all()


def test_the_smallest_draw_gives_a_finite_deviate():
    draws, deviates = np.zeros((1, 2)), np.empty((1, 1))
    for value in (0.0, 1.0 - 2.0**-53):
        draws[:] = value
        normals(draws, deviates)
        assert np.isfinite(deviates).all()
        student_t(draws, np.full((1, 1), 0.5), deviates)
        assert np.isfinite(deviates).all()
