import numpy as np
import pytest

from selforg.components import Commands, DriveLimits, differential, holonomic

LIMITS = DriveLimits(max_speed=1.0, max_turn_rate=2.0, turn_gain=2.0)
VECTORS = np.array([[0.5, 0.0], [3.0, 4.0], [0.0, 0.5], [-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]])


def commands(in_place=False, commanded=True):
    rows = len(VECTORS)
    return Commands(VECTORS.copy(), np.full(rows, commanded), np.full(rows, in_place))


def test_a_differential_drive_goes_ahead_or_turns():
    speed, turn = differential(commands(), np.zeros(6), LIMITS)
    np.testing.assert_allclose(speed, [0.5, 1.0, 0.0, 0.0, 0.0, 1.0])
    np.testing.assert_allclose(turn, [0.0, 2 * np.arctan2(4, 3), 2.0, -2.0, 0.0, 0.0])


def test_a_differential_drive_turns_the_shorter_way():
    _, turn = differential(commands(), np.full(6, -3.0), LIMITS)
    np.testing.assert_allclose(turn[3], 2.0 * (np.pi - 2 * np.pi + 3.0))


def test_a_holonomic_drive_goes_where_the_vector_points():
    velocity, turn = holonomic(commands(), np.linspace(0.0, 3.0, 6), LIMITS)
    np.testing.assert_allclose(velocity, [[0.5, 0.0], [0.6, 0.8], [0.0, 0.5], [-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    np.testing.assert_array_equal(turn, np.zeros(6))


@pytest.mark.parametrize("drive", [differential, holonomic])
def test_turning_in_place_moves_nothing(drive):
    motion, turn = drive(commands(in_place=True), np.zeros(6), LIMITS)
    assert not motion.any()
    np.testing.assert_allclose(turn, [0.0, 2 * np.arctan2(4, 3), 2.0, -2.0, 0.0, 0.0])


@pytest.mark.parametrize("drive", [differential, holonomic])
def test_without_a_command_a_robot_stands(drive):
    motion, turn = drive(commands(commanded=False), np.full(6, 1.0), LIMITS)
    assert not motion.any()
    assert not turn.any()


def test_impossible_limits_are_refused():
    with pytest.raises(ValueError, match="max_turn_rate: expected a positive number, got 0"):
        DriveLimits(max_turn_rate=0)
