"""Facts that robots tell: what is heard, by whom, how long, and how much is stored."""

import numpy as np
import pytest

from selforg.components import FactRule, SharedFact
from selforg.components.facts import SHARED_FACTS
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.poses import OwnPoses
from selforg.space import Euclidean

ALL = np.arange(3)
NOBODY = (0.0, -1)


def fact(rule=None, delivery=None):
    """A fact of three robots at 0, 1 and 10 m."""
    poses = OwnPoses(Euclidean(2), 3)
    poses.update(np.array([[0.0, 0.0], [1.0, 0.0], [10.0, 0.0]]), np.zeros(3), 0.0)
    given = Delivery(**delivery, generators=[np.random.default_rng(1)] * 3) if delivery else None
    return SharedFact(SoBuffer(SHARED_FACTS, poses.space, poses, given), "fact", FactRule(**(rule or {})))


def heard(one, now):
    """Value and teller of each robot."""
    one._buffer.deliver(now)
    one.ask(now, ALL)
    return list(zip(one.values.tolist(), one.tellers.tolist(), strict=True))


@pytest.mark.parametrize(
    ("rule", "delivery", "expected"),
    [
        ({}, None, [(2.0, 2)] * 3),
        ({"keep": "largest"}, None, [(7.0, 0)] * 3),
        ({"view_distance": 2.0}, None, [(7.0, 0), (7.0, 0), (2.0, 2)]),
        ({}, {"reach": 3.0}, [(7.0, 0), (7.0, 0), (2.0, 2)]),
        ({}, {"loss": 1.0}, [(7.0, 0), NOBODY, (2.0, 2)]),
        ({}, {"delay": 2.0}, [(7.0, 0)] * 3),  # the second one is still under way, to the robot itself, too
        ({"keep": "largest", "evaporation_factor": 0.0, "evaporation_period": 2.0}, None, [(2.0, 2)] * 3),
        ({"evaporation_factor": 0.5, "evaporation_period": 0.1}, None, [NOBODY] * 3),
    ],
)
def test_the_newest_or_the_largest_is_heard_as_far_and_as_long_as_gradients_are(rule, delivery, expected):
    one = fact(rule, delivery)
    one.tell(0.0, np.array([0]), 7.0)
    one.tell(1.0, np.array([2]), 2.0)
    assert heard(one, 2.5) == expected
    assert heard(one, 2.5) == expected


def test_ten_times_the_traffic_stores_no_more_and_a_cleared_buffer_is_forgotten():
    one = fact()
    for tick in range(100):
        one.tell(0.02 * tick, ALL)
    assert len(one._buffer) == 3
    assert heard(one, 2.0) == [(1.0, 0)] * 3
    one._buffer.clear(0)
    assert heard(one, 2.0) == [NOBODY] * 3


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1.1e9])
def test_what_is_no_finite_number_is_refused_in_one_line_and_told_to_nobody(value):
    one = fact()
    with pytest.raises(ValueError, match=r"^fact fact: expected finite numbers up to 1e\+09, got [-a-z0-9.e+]+$"):
        one.tell(0.0, ALL, [1.0, value, 1.0])
    assert heard(one, 0.2) == [NOBODY] * 3
