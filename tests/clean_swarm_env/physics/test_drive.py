"""The drive against its formula, and the life of a command."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clean_swarm_env.physics.drive import DifferentialDrive, update_drives

EVERYBODY = np.ones(1, np.bool_)
NOBODY = np.zeros(1, np.bool_)


def command(drive, vectors, commanded, headings, now):
    update_drives(vectors, commanded, np.zeros(len(vectors), np.bool_), headings, now, drive.packed.handle)


def drive_of_one(vector, heading, **limits):
    drive = DifferentialDrive(1, **limits)
    command(drive, np.array([vector], float), EVERYBODY, np.array([heading], float), 0.0)
    return drive.speed[0], drive.turn_rate[0]


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-math.pi, math.pi, exclude_min=True))
def test_the_published_formula(x, y, heading):
    speed, turn_rate = drive_of_one((x, y), heading)
    length = math.hypot(x, y)
    if length == 0.0:
        assert (speed, turn_rate) == (0.0, 0.0)
        return
    error = (math.atan2(y, x) - heading + 3 * math.pi) % (2 * math.pi) - math.pi
    if math.pi - abs(error) > 1e-9:  # straight behind, either way round is right
        assert turn_rate == pytest.approx(min(max(2 * error, -2), 2), abs=1e-9)
    if abs(abs(error) - math.pi / 3) > 1e-9:
        assert speed == pytest.approx(min(length, 1.0) if abs(error) < math.pi / 3 else 0.0)


@pytest.mark.parametrize(
    ("vector", "heading", "expected"),
    [
        ((0.4, 0.0), 0.0, (0.4, 0.0)),
        ((5.0, 0.0), 0.0, (1.0, 0.0)),
        ((math.cos(0.5), math.sin(0.5)), 0.25, (1.0, 0.5)),
        ((0.0, 1.0), 0.0, (0.0, 2.0)),  # 90 degrees: turn in place, at the limit
        ((-1.0, 0.1), -3.0, (1.0, 2.0 * (math.atan2(0.1, -1.0) + 3.0 - 2.0 * math.pi))),  # across +-pi
        ((0.0, 0.0), 1.0, (0.0, 0.0)),
    ],
)
def test_cases_worked_by_hand(vector, heading, expected):
    assert drive_of_one(vector, heading) == pytest.approx(expected)


def test_settings_are_used():
    assert drive_of_one((5.0, 0.5), 0.0, max_speed=0.3, turn_gain=4.0) == pytest.approx((0.3, 4 * math.atan2(0.5, 5.0)))
    assert drive_of_one((0.0, 5.0), 0.0, max_turn_rate=0.7, turn_in_place_beyond=3.0) == pytest.approx((1.0, 0.7))


def test_a_command_holds_for_its_time_and_a_new_one_begins_it_again():
    drive = DifferentialDrive(1)
    history = []
    for tick in range(16):
        commanded = EVERYBODY if tick in (0, 3) else NOBODY
        command(drive, np.array([[0.5, 0.0]]), commanded, np.zeros(1), 0.2 * tick)
        history.append(drive.speed[0])
    # From the command of tick 3 on for five control periods of 0.2 s, which are one second.
    assert history == [0.5] * 8 + [0.0] * 8


def test_the_held_command_is_not_computed_again():
    drive = DifferentialDrive(1)
    command(drive, np.array([[1.0, 1.0]]), EVERYBODY, np.zeros(1), 0.0)
    before = drive.turn_rate[0]
    command(drive, np.array([[-1.0, 0.0]]), NOBODY, np.array([2.0]), 0.2)
    assert drive.turn_rate[0] == before


def test_rows_do_not_see_each_other_and_inputs_stay():
    rng = np.random.default_rng(3)
    vectors, headings, has_command = rng.normal(size=(20, 2)), rng.uniform(-3, 3, 20), rng.random(20) < 0.7
    copies = vectors.copy(), headings.copy(), has_command.copy()
    drive, permuted, order = DifferentialDrive(20), DifferentialDrive(20), rng.permutation(20)
    command(drive, vectors, has_command, headings, 0.0)
    command(permuted, vectors[order], has_command[order], headings[order], 0.0)
    assert np.array_equal(drive.speed[order], permuted.speed)
    assert np.array_equal(drive.turn_rate[order], permuted.turn_rate)
    assert all(np.array_equal(new, old) for new, old in zip((vectors, headings, has_command), copies, strict=True))


def test_reset_stops_the_rows_it_names_only():
    drive = DifferentialDrive(3)
    command(drive, np.full((3, 2), 0.5), np.ones(3, np.bool_), np.zeros(3), 0.0)
    drive.reset(slice(0, 2))
    assert (drive.speed > 0).tolist() == [False, False, True]
    assert (drive.turn_rate != 0).tolist() == [False, False, True]
