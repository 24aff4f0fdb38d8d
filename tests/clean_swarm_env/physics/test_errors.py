"""Wheels that slip: how far robots get, and that others are not touched."""

import numpy as np
import pytest

from tests.clean_swarm_env.courses import mission, worlds_at_start

AHEAD = np.array([[0.5, 0.0], [0.5, 0.0]])


def _ways(ticks=600, around=False, **robot):
    """How far two robots get in each tick that drive straight on with 0.5 m/s, and how far they turn.

    With `around` they are told in each tick to drive to where they come from, so they turn as fast as they can.
    """
    worlds = worlds_at_start(mission(robots={"count": 2, **robot}, garbage={"count": 0}), [1])

    def tick():
        back = worlds.physics.headings + np.pi
        worlds.drive(0.5 * np.column_stack([np.cos(back), np.sin(back)]) if around else AHEAD)
        worlds.tick()

    for _ in range(50):
        tick()
    ways, turns = [], []
    for _ in range(ticks):
        places, headings = worlds.physics.positions.copy(), worlds.physics.headings.copy()
        tick()
        ways.append(np.linalg.norm(worlds.floor.ground.space.offsets(places, worlds.physics.positions), axis=1))
        turns.append(worlds.physics.headings - headings)
    return np.array(ways) / worlds.period, np.array(turns)


def test_wheels_that_slip_give_the_mean_speed_with_errors_of_their_size():
    ways, turns = _ways(slip=0.2)
    assert ways.mean() == pytest.approx(0.5, rel=0.03)
    assert ways.std() == pytest.approx(0.1, rel=0.15)
    assert abs(np.corrcoef(ways[:-1, 0], ways[1:, 0])[0, 1]) < 0.15
    assert abs(np.corrcoef(ways.T)[0, 1]) < 0.15
    assert np.abs(turns).max() < 1e-9  # a turn rate of nothing slips by nothing


def test_turn_rates_slip_as_speeds_do():
    (_, exact), (_, turns) = _ways(around=True), _ways(around=True, slip=0.2)
    exact, turns = (np.abs((one + np.pi) % (2.0 * np.pi) - np.pi) for one in (exact, turns))
    assert exact.min() == pytest.approx(exact.max())
    assert turns.mean() == pytest.approx(exact.mean(), rel=0.03)
    assert turns.std() == pytest.approx(0.2 * exact.mean(), rel=0.15)
    assert abs(np.corrcoef(turns.T)[0, 1]) < 0.15


def test_wheels_do_not_slip_unless_they_are_told_to():
    ways, _ = _ways(ticks=20)
    assert ways == pytest.approx(0.5)
