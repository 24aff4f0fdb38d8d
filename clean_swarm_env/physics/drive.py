"""Differential drive: a movement vector becomes a speed along the heading and a turn rate towards the vector."""

from math import pi
from typing import Annotated, Final, NamedTuple

import numpy as np

from clean_swarm_env.physics.motion import wrapped_angle
from selforg.arrays import CLOCKED, KEPT, READ, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Packed, Written, opening
from selforg.elementary import direction, length_of

TIMEOUT_TOLERANCE: Final = 1e-9  # [s]; sums of control periods miss a whole second by less than this


class DriveState(NamedTuple):
    """Speeds and turn rates of the drives, and their settings."""

    speed: Annotated[Floats, "R", KEPT]  # along the heading [m/s]
    turn_rate: Annotated[Floats, "R", KEPT]  # [rad/s]
    commanded_at: Annotated[Floats, "R", CLOCKED]  # time of the last command [s]; undefined for a robot at rest
    grip: Annotated[Floats, "R 2", READ]  # share of a commanded speed, and of a turn rate, that a robot gets [-]
    max_speed: Annotated[Floats, "R", READ]  # [m/s]
    max_turn_rate: Annotated[Floats, "R", READ]  # [rad/s]
    turn_gain: Annotated[Floats, "R", READ]  # turn rate per heading error [1/s]
    turn_in_place_beyond: Annotated[Floats, "R", READ]  # heading error from which on the robot only turns [rad]
    command_timeout: Annotated[Floats, "R", READ]  # time without a command after which a robot stops [s]


open_drive = opening(DriveState)


class DifferentialDrive:
    """Drives of R robots; a command is valid until the next one, or until `command_timeout` has passed.

    speed: (R,) float64 [m/s] along the heading; the same array all the time.
    turn_rate: (R,) float64 [rad/s]; the same array all the time.
    grip: (R, 2) float64 [-], 1 at first: what robots get of a commanded speed and turn rate; written by the owner.
    max_speed: (R,) float64 [m/s]; read only.
    packed: the record that compiled code takes; its settings are the arguments, each a number or (R,).

    >>> drive = DifferentialDrive(rows=2)
    >>> vectors, commanded, in_place = np.array([[0.5, 0.0], [0.0, 2.0]]), np.ones(2, np.bool_), np.zeros(2, np.bool_)
    >>> update_drives(vectors, commanded, in_place, headings=np.zeros(2), now=0.0, drive=drive.packed.handle)
    >>> drive.speed.tolist(), drive.turn_rate.tolist()
    ([0.5, 0.0], [0.0, 2.0])
    """

    max_speed: Annotated[Floats, "R", READ]

    def __init__(
        self,
        rows: int,
        *,
        max_speed: float | Floats = 1.0,
        max_turn_rate: float | Floats = 2.0,
        turn_gain: float | Floats = 2.0,
        turn_in_place_beyond: float | Floats = pi / 3.0,
        command_timeout: float | Floats = 1.0,
    ) -> None:
        settings = max_speed, max_turn_rate, turn_gain, turn_in_place_beyond, command_timeout
        limits = [np.full(rows, setting, dtype=np.float64) for setting in settings]
        self.max_speed = limits[0]
        self.packed: Packed[DriveState] = Packed(
            DriveState(np.zeros(rows), np.zeros(rows), np.zeros(rows), np.ones((rows, 2)), *limits)
        )
        self.speed, self.turn_rate, self._commanded_at, self.grip = self.packed.record[:4]

    def reset(self, rows: Ints | slice) -> None:
        """Stop the robots in `rows`, as at the beginning."""
        self.speed[rows] = 0.0
        self.turn_rate[rows] = 0.0
        self._commanded_at[rows] = 0.0


@lean_kernel
def update_drives(
    vectors: Floats, commanded: Flags, in_place: Flags, headings: Floats, now: float, drive: Written[DriveState]
) -> None:
    """Take the commands of this instant and update speeds and turn rates.

    vectors (R, 2) [m/s] counts where commanded (R,) is set; headings (R,) [rad] in (-pi, pi]; now [s].
    A zero vector is a command to stand still. A robot whose last command is `command_timeout` old stops. Where
    `in_place` (R,) is set, a robot turns without driving.
    """
    d = open_drive(drive)
    for row in range(d.speed.shape[0]):
        if commanded[row]:
            x, y = vectors[row, 0], vectors[row, 1]
            length = length_of(x, y)
            d.commanded_at[row] = now
            if length > 0.0:
                error = wrapped_angle(direction(y, x) - headings[row])
                most = d.max_turn_rate[row]
                d.turn_rate[row] = d.grip[row, 1] * min(max(d.turn_gain[row] * error, -most), most)
                straight = abs(error) < d.turn_in_place_beyond[row]
                d.speed[row] = d.grip[row, 0] * min(length, d.max_speed[row]) if straight else 0.0
            else:
                d.speed[row] = 0.0
                d.turn_rate[row] = 0.0
        elif now - d.commanded_at[row] > d.command_timeout[row] - TIMEOUT_TOLERANCE:
            d.speed[row] = 0.0
            d.turn_rate[row] = 0.0
        if in_place[row]:
            d.speed[row] = 0.0
