import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from selforg.space import Euclidean, Torus, nearest_image, wrapped


@given(st.floats(-1e6, 1e6), st.floats(0.1, 100.0))
def test_wrapping_ends_inside(x, extent):
    assert 0.0 <= wrapped(x, extent) < extent
    assert Torus(extent, 1.0).wrap(np.array([x, 0.0]))[0] < extent


@given(st.floats(0, 10.999), st.floats(0, 10.999))
def test_the_nearest_image_is_the_shortest_of_three(a, b):
    assert abs(nearest_image(b - a, 11.0)) == pytest.approx(min(abs(b - a + k) for k in (-11, 0, 11)), abs=1e-12)


def test_offsets_cross_the_seam_on_a_torus_only():
    one, other = np.array([[0.5, 0.5]]), np.array([[10.5, 6.5]])
    np.testing.assert_allclose(Torus(11.0, 7.0).offsets(one, other), [[-1.0, -1.0]])
    np.testing.assert_allclose(Euclidean(2).offsets(one, other), [[10.0, 6.0]])


def test_half_a_torus_away_the_way_goes_as_the_coordinates_do():
    one, other = np.array([1.0, 1.0]), np.array([3.0, 4.0])
    torus = Torus(4.0, 6.0)
    assert torus.offsets(one, other).tolist() == [2.0, 3.0]
    assert torus.offsets(other, one).tolist() == [-2.0, -3.0]
    assert (nearest_image(2.0, 4.0), nearest_image(-2.0, 4.0)) == (2.0, -2.0)


@pytest.mark.parametrize("size", [0.0, -1.0, np.inf, np.nan])
def test_a_torus_needs_a_positive_finite_size(size):
    with pytest.raises(ValueError, match="width must be positive"):
        Torus(size, 1.0)
