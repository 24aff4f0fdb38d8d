"""The safety filter slows down before obstacles and never speeds up; what robots sense keeps its bits as text."""

from types import SimpleNamespace

import numpy as np
import pytest

from clean_swarm_env.robots.sensed import SeenItem, Sensed, Wheels
from examples.robots.safety import SLOW, STOP, kept_clear
from examples.ros.wire import as_text, from_text

FAST = Wheels(0.3, 0.5, (0.3, 0.0), ("PickGarbage",))


def scan(*ranges, first=-0.5, step=0.5):
    """Return a scan whose beams begin at an angle [rad]."""
    return SimpleNamespace(ranges=list(ranges), angle_min=first, angle_increment=step, range_min=0.02)


@pytest.mark.parametrize(
    ("ranges", "share"),
    [
        ((), 1.0),
        ((5.0, 5.0, 5.0), 1.0),
        ((np.inf, np.nan, 0.01), 1.0),  # nothing, broken, and the robot itself
        ((5.0, 0.1 + SLOW, 5.0), 1.0),
        ((5.0, 0.1 + 0.5 * (STOP + SLOW), 5.0), 0.5),
        ((5.0, 0.1 + STOP, 5.0), 0.0),
        ((0.05, 5.0, 5.0), 0.0),
    ],
)
def test_the_nearest_beam_ahead_says_how_fast_a_robot_may_drive(ranges, share):
    clear = kept_clear(FAST, scan(*ranges), radius=0.1)
    assert clear.speed == pytest.approx(share * 0.3)
    assert clear.vector == pytest.approx((share * 0.3, 0.0))
    assert (clear.turn_rate, clear.handles) == (0.5, ("PickGarbage",))  # it may turn away


def test_without_anything_ahead_a_command_keeps_its_bits():
    wheels = Wheels(0.1 + 0.2, 1 / 3, (2 / 3, 0.7))
    assert kept_clear(wheels, scan(), radius=0.1) == wheels


def test_what_is_beside_or_behind_stops_nobody():
    assert kept_clear(FAST, scan(0.1, 0.1, first=1.2, step=1.9), radius=0.1).speed == 0.3


def test_what_a_robot_senses_keeps_its_bits_as_text():
    items = {3: SeenItem(0.1 + 0.2, np.nextafter(1.0, 2.0), True)}
    sensed = Sensed(1 / 3, 0.1, 2.0, -3.1, 2, ((0.7, 0.1),), items, (4, 1), True)
    assert from_text(as_text(sensed)) == sensed
