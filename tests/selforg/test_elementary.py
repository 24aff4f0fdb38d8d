"""The elementary functions beside NumPy's of 64 bits of mantissa, and where their pieces meet."""

import hashlib
import math

import numpy as np
import pytest

from selforg.compiler.decorators import kernel
from selforg.elementary import (
    direction,
    directions,
    exponentials,
    growth,
    hyperbolic_tangent,
    length_of,
    logarithms,
    unit_vectors,
    whole_power,
)

MANY = 100_000


@pytest.fixture
def draws():
    return np.random.default_rng(7)


def last_places(found, exact):
    """Return the largest error in units of the last place."""
    return float((np.abs(found - exact) / np.spacing(np.abs(exact).astype(np.float64))).max())


@kernel
def grown(values, results):
    for index in range(len(values)):
        results[index, 0] = growth(values[index])
        results[index, 1] = hyperbolic_tangent(values[index])


@pytest.mark.parametrize("largest", [1.0, 7.0, 1e3])
def test_sines_and_cosines(draws, largest):
    angles = draws.uniform(-largest, largest, MANY)
    cosines, sines = unit_vectors(angles)
    exact = angles.astype(np.longdouble)
    assert last_places(sines, np.sin(exact)) < 2.0
    assert last_places(cosines, np.cos(exact)) < 2.0


def test_whole_quarters_of_a_turn():
    cosines, sines = unit_vectors(np.arange(-8, 9) * (np.pi / 2.0))
    assert np.allclose(cosines, np.round(cosines), atol=1e-14)
    assert np.allclose(sines, np.round(sines), atol=1e-14)
    np.testing.assert_array_equal(np.round(sines[8:12]), [0.0, 1.0, 0.0, -1.0])


def test_directions(draws):
    vectors = draws.normal(size=(MANY, 2)) * 10.0 ** draws.uniform(-3, 3, (MANY, 2))
    exact = vectors.astype(np.longdouble)
    assert last_places(directions(vectors), np.arctan2(exact[:, 1], exact[:, 0])) < 2.5


@pytest.mark.parametrize(
    ("y", "x"), [(0, 0), (0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (-1, -1), (1, -1), (1e-300, -1)]
)
def test_directions_along_the_axes(y, x):
    assert direction(float(y), float(x)) == pytest.approx(math.atan2(y, x), abs=1e-15)


def test_exponentials_and_logarithms(draws):
    powers = draws.uniform(-700.0, 700.0, MANY)
    assert last_places(exponentials(powers), np.exp(powers.astype(np.longdouble))) < 1.5
    for values in (10.0 ** draws.uniform(-300.0, 300.0, MANY), draws.uniform(0.5, 2.0, MANY)):
        assert last_places(logarithms(values), np.log(values.astype(np.longdouble))) < 3.0


def test_ends_of_exponentials_and_logarithms():
    np.testing.assert_array_equal(exponentials(np.array([-np.inf, -1e3, 0.0, 1e3, np.inf])), [0, 0, 1, np.inf, np.inf])
    np.testing.assert_array_equal(logarithms(np.array([0.0, 1.0])), [-np.inf, 0.0])
    assert exponentials(np.array([[-745.0, 709.7]])).shape == (1, 2)
    np.testing.assert_allclose(exponentials(np.array([-745.0, 709.7])), np.exp([-745.0, 709.7]), rtol=1e-13)


def test_growth_and_hyperbolic_tangent_also_of_small_numbers(draws):
    values = np.concatenate([draws.uniform(-5.0, 5.0, MANY), draws.uniform(-1.0, 1.0, MANY) * 1e-8])
    results = np.empty((len(values), 2))
    grown(values, results)
    exact = values.astype(np.longdouble)
    assert last_places(results[:, 0], np.expm1(exact)) < 5.0
    assert last_places(results[:, 1], np.tanh(exact)) < 5.0


@pytest.mark.parametrize(("x", "y"), [(3.0, -4.0), (0.0, 0.0), (-1e-200, 1e-200), (1e200, 1e200), (0.0, 5e-324)])
def test_lengths_also_of_very_short_and_very_long_vectors(x, y):
    assert length_of(x, y) == pytest.approx(math.hypot(x, y), rel=1e-15)


@pytest.mark.parametrize(("base", "exponent"), [(0.5, 0), (0.5, 1), (0.9, 7), (0.999, 12345), (0.0, 3)])
def test_whole_powers(base, exponent):
    assert whole_power(base, float(exponent)) == pytest.approx(base**exponent, rel=1e-12)


def test_every_bit_stays_as_it_is():
    """A change in any term of a series, where errors of the last place do not show it, changes the courses."""
    values = np.arange(1, 20_001) / 4096.0
    vectors = np.column_stack((values - 2.0, values[::-1]))
    found = (*unit_vectors(values), directions(vectors), exponentials(-values), logarithms(values))
    assert hashlib.sha256(np.concatenate(found).tobytes()).hexdigest()[:16] == "73335247d42a4f03"
