"""Potentials at the places where one case of a formula meets the next."""

import math

import pytest

from selforg.potentials import attraction_balch, attraction_ge, repulsion_balch, repulsion_fernandez, repulsion_ge


def test_repulsion_is_full_at_exactly_no_clearance():
    assert repulsion_balch(0.0, 1.0) == math.inf
    assert repulsion_fernandez(0.0, 1.5, 0.5) == math.inf
    assert repulsion_ge(0.0, 1.0, 2.0) == (math.inf, 0.0)
    assert repulsion_balch(1e-12, 1.0) == pytest.approx(1.0)
    assert repulsion_fernandez(1e-12, 1.5, 0.5) == pytest.approx(0.75e12)


def test_attraction_is_none_at_exactly_no_clearance():
    assert attraction_balch(0.0, 1.0, 0.5) == 0.0
    assert attraction_ge(0.0, 0.0) == 0.0


def test_the_diffusion_belongs_to_what_it_bounds():
    assert attraction_balch(2.0, 2.0, 3.0) == 1.0
    assert attraction_balch(math.nextafter(2.0, 3.0), 2.0, 3.0) == 3.0
    assert repulsion_balch(2.0, 2.0) == 0.0
    assert repulsion_balch(1.0, 2.0) == 0.5
    assert attraction_ge(2.0, 2.0) == 2.0
    assert attraction_ge(3.0, 2.0) == 2.0
    assert repulsion_ge(2.0, 2.0, 1.0) == (0.0, 0.0)
