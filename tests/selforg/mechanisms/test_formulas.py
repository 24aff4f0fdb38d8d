"""Formulas at the places where one case of a formula meets the next."""

import math

import pytest

from selforg.gradients.pair import Pair, attraction_balch, repulsion_balch
from selforg.mechanisms import RepulsionFernandez, RepulsionGradient
from selforg.mechanisms.chemotaxis import attraction_ge, repulsion_ge


def pair(clearance, diffusion, distance=0.5):
    """A pair of a robot of reach 1.5 m and a gradient without a goal radius."""
    return Pair(distance, clearance, diffusion, 0.0, 1.0, 0.0, own_reach=1.5, view_distance=2.0)


def test_repulsion_is_full_at_exactly_no_clearance():
    assert repulsion_balch(pair(0.0, 1.0)) == math.inf
    assert repulsion_ge(pair(0.0, 1.0), 2.0) == (math.inf, 0.0)
    assert RepulsionFernandez.formula(pair(0.0, 1.0, distance=0.0)) == -math.inf
    assert RepulsionGradient.formula(pair(0.0, 1.0)) == -math.inf
    assert repulsion_balch(pair(1e-12, 1.0)) == pytest.approx(1.0)
    near = pair(1e-12, 1.0)._replace(goal_radius=0.5, distance=0.5 + 1e-12)
    assert RepulsionFernandez.formula(near) == pytest.approx(-0.75e12, rel=1e-3)


def test_neighbours_repel_up_to_the_own_reach_attract_beyond_and_are_not_seen_beyond_the_view_distance():
    lengths = [RepulsionFernandez.formula(pair(d, 1.0, distance=d)) for d in (1.0, 1.5, 2.0, math.nextafter(2.0, 3.0))]
    assert lengths == [-0.5, 0.0, 0.5, 0.0]


def test_attraction_is_none_at_exactly_no_clearance():
    assert attraction_balch(pair(0.0, 1.0)) == 0.0
    assert attraction_ge(pair(0.0, 0.0)) == 0.0


def test_the_diffusion_belongs_to_what_it_bounds():
    assert attraction_balch(pair(2.0, 2.0, 3.0)) == 1.0
    assert attraction_balch(pair(math.nextafter(2.0, 3.0), 2.0, 3.0)) == 3.0
    assert repulsion_balch(pair(2.0, 2.0)) == 0.0
    assert repulsion_balch(pair(1.0, 2.0)) == 0.5
    assert attraction_ge(pair(2.0, 2.0)) == 2.0
    assert attraction_ge(pair(3.0, 2.0)) == 2.0
    assert repulsion_ge(pair(2.0, 2.0), 1.0) == (0.0, 0.0)
