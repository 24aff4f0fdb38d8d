"""Student's distribution against SciPy's."""

import math

import pytest
import scipy.stats

from train.student import tail_begins, tail_beyond

FREEDOMS = (1.0, 1.0001, 1.5, 2.0, 3.0, 5.5, 9.0, 29.0, 30.7, 99.0, 300.0, 5000.0)


@pytest.mark.parametrize("freedom", FREEDOMS)
def test_tails_are_those_of_scipy(freedom):
    for t in (0.0, 1e-3, 0.3, 0.7, 1.0, 2.0, 3.3, 12.0, 1e3, 1e9):
        assert tail_beyond(t, freedom) == pytest.approx(scipy.stats.t.sf(t, freedom), rel=1e-10, abs=1e-300)
    for tail in (0.5, 0.4, 0.1, 0.05, 0.025, 0.025 / 3.0, 1e-3, 1e-6):
        assert tail_begins(tail, freedom) == pytest.approx(scipy.stats.t.isf(tail, freedom), rel=1e-10, abs=1e-15)


def test_ends_are_defined_and_what_is_no_number_stays_none():
    assert tail_beyond(math.inf, 3.0) == tail_beyond(1e200, 3.0) == 0.0
    assert math.isnan(tail_beyond(math.nan, 3.0))
    assert math.isnan(tail_beyond(1.0, math.nan))
    assert math.isnan(tail_begins(0.025, math.nan))
