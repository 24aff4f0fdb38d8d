"""Formulas at the places where one case of a formula meets the next."""

import math

import pytest

from selforg.gradients.pair import Pair, attraction_balch, repulsion_balch
from selforg.mechanisms import RepulsionFernandez, RepulsionGradient
from selforg.mechanisms.chemotaxis import attraction_ge, repulsion_ge


def pair(clearance, diffusion, distance=0.5):
    """A pair of a robot of reach 1.5 m and a gradient without a goal radius."""
    return Pair(distance, clearance, diffusion, 0.0, 1.0, 0.0, own_reach=1.5, view_distance=2.0)


BEYOND_2 = math.nextafter(2.0, 3.0)


@pytest.mark.parametrize(
    ("formula", "of", "expected"),
    [
        # repulsion is full at exactly no clearance
        (repulsion_balch, pair(0.0, 1.0), math.inf),
        (RepulsionFernandez.formula, pair(0.0, 1.0, distance=0.0), -math.inf),
        (RepulsionGradient.formula, pair(0.0, 1.0), -math.inf),
        (repulsion_balch, pair(1e-12, 1.0), pytest.approx(1.0)),
        (
            RepulsionFernandez.formula,
            pair(1e-12, 1.0)._replace(goal_radius=0.5, distance=0.5 + 1e-12),
            pytest.approx(-0.75e12, rel=1e-3),
        ),
        # attraction is none there
        (attraction_balch, pair(0.0, 1.0), 0.0),
        (attraction_ge, pair(0.0, 0.0), 0.0),
        # the diffusion belongs to what it bounds
        (attraction_balch, pair(2.0, 2.0, 3.0), 1.0),
        (attraction_balch, pair(BEYOND_2, 2.0, 3.0), 3.0),
        (repulsion_balch, pair(2.0, 2.0), 0.0),
        (repulsion_balch, pair(1.0, 2.0), 0.5),
        (attraction_ge, pair(2.0, 2.0), 2.0),
        (attraction_ge, pair(3.0, 2.0), 2.0),
        # neighbours repel up to the own reach, attract beyond, and are not seen beyond the view distance
        *((RepulsionFernandez.formula, pair(d, 1.0, distance=d), length)
          for d, length in ((1.0, -0.5), (1.5, 0.0), (2.0, 0.5), (BEYOND_2, 0.0))),
    ],
)  # fmt: skip
def test_a_formula_at_its_borders(formula, of, expected):
    assert formula(of) == expected


@pytest.mark.parametrize(("of", "given", "expected"), [
    (pair(0.0, 1.0), 2.0, (math.inf, 0.0)), (pair(2.0, 2.0), 1.0, (0.0, 0.0)),
])  # fmt: skip
def test_repulsion_of_ge_at_its_borders(of, given, expected):
    assert repulsion_ge(of, given) == expected
