"""Differential drive: a movement vector becomes a speed along the heading and a turn rate towards the vector."""

from dataclasses import astuple, dataclass
from math import isfinite, pi
from typing import Annotated, Final, NamedTuple

import numpy as np

from clean_swarm_env.physics.motion import wrapped_angle
from selforg.arrays import CLOCKED, KEPT, READ, Flags, Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Packed, Recording, Written
from selforg.elementary import direction, length_of

TIMEOUT_TOLERANCE: Final = 1e-9  # [s]; sums of control periods miss a whole second by less than this


@dataclass(frozen=True)
class DriveSettings:
    """Limits and gain of the drive; impossible values raise ValueError."""

    max_speed: float = 1.0  # [m/s]
    max_turn_rate: float = 2.0  # [rad/s]
    turn_gain: float = 2.0  # [1/s], turn rate per heading error
    turn_in_place_beyond: float = pi / 3.0  # [rad] of heading error from which on the robot only turns
    command_timeout: float = 1.0  # [s] without a command after which a robot stops

    def __post_init__(self) -> None:
        for name in ("max_speed", "max_turn_rate", "turn_gain", "turn_in_place_beyond", "command_timeout"):
            if not (getattr(self, name) > 0.0 and isfinite(getattr(self, name))):
                raise ValueError(f"{name}: expected a positive number, got {getattr(self, name)}")


class DriveState(NamedTuple):
    """Speeds and turn rates of the drives, and their settings."""

    speed: Annotated[Floats, "R", KEPT]  # along the heading [m/s]
    turn_rate: Annotated[Floats, "R", KEPT]  # [rad/s]
    commanded_at: Annotated[Floats, "R", CLOCKED]  # time of the last command [s]; undefined for a robot at rest
    max_speed: float  # from here on: fields of DriveSettings
    max_turn_rate: float
    turn_gain: float
    turn_in_place_beyond: float
    command_timeout: float


DRIVE = Recording(DriveState)
open_drive = DRIVE.open


class DifferentialDrive:
    """Drives of R robots; a command is valid until the next one, or until `command_timeout` has passed.

    speed: (R,) float64 [m/s] along the heading; the same array all the time, as Physics.substep takes it.
    turn_rate: (R,) float64 [rad/s]; the same array all the time.
    packed: the record that compiled code takes.

    Raises ValueError for less than one row.

    >>> drive = DifferentialDrive(rows=2)
    >>> drive.command(np.array([[0.5, 0.0], [0.0, 2.0]]), np.array([True, True]), headings=np.zeros(2), now=0.0)
    >>> drive.speed.tolist(), drive.turn_rate.tolist()
    ([0.5, 0.0], [0.0, 2.0])
    """

    _nowhere: Annotated[Flags, "R", READ]

    def __init__(self, rows: int, settings: DriveSettings | None = None) -> None:
        if rows < 1:
            raise ValueError(f"rows: expected at least 1, got {rows}")
        self.settings = settings or DriveSettings()
        self.speed: Floats = np.zeros(rows)
        self.turn_rate: Floats = np.zeros(rows)
        self._commanded_at: Floats = np.zeros(rows)
        self._nowhere = np.zeros(rows, np.bool_)
        self.packed: Packed[DriveState] = DRIVE.pack(
            DriveState(self.speed, self.turn_rate, self._commanded_at, *astuple(self.settings))
        )

    def command(
        self, vectors: Floats, has_command: Flags, headings: Floats, now: float, in_place: Flags | None = None
    ) -> None:
        """Take the commands of this instant and update `speed` and `turn_rate`.

        vectors (R, 2) [m/s] counts where has_command (R,) is set; headings (R,) [rad] in (-pi, pi]; now [s].
        A zero vector is a command to stand still. A robot whose last command is `command_timeout` old stops. Where
        `in_place` (R,) is set, a robot turns without driving.
        """
        turning = self._nowhere if in_place is None else in_place
        update_drives(vectors, has_command, turning, headings, now, self.packed.words)

    def reset(self, rows: Ints | slice) -> None:
        """Stop the robots in `rows`, as at the beginning."""
        self.speed[rows] = 0.0
        self.turn_rate[rows] = 0.0
        self._commanded_at[rows] = 0.0


@lean_kernel
def update_drives(
    vectors: Floats, commanded: Flags, in_place: Flags, headings: Floats, now: float, drive: Written[DriveState]
) -> None:
    """Update what the drives do; see `DifferentialDrive.command`."""
    d = open_drive(drive)
    for row in range(d.speed.shape[0]):
        if commanded[row]:
            x, y = vectors[row, 0], vectors[row, 1]
            length = length_of(x, y)
            d.commanded_at[row] = now
            if length > 0.0:
                error = wrapped_angle(direction(y, x) - headings[row])
                d.turn_rate[row] = min(max(d.turn_gain * error, -d.max_turn_rate), d.max_turn_rate)
                d.speed[row] = min(length, d.max_speed) if abs(error) < d.turn_in_place_beyond else 0.0
            else:
                d.speed[row] = 0.0
                d.turn_rate[row] = 0.0
        elif now - d.commanded_at[row] > d.command_timeout - TIMEOUT_TOLERANCE:
            d.speed[row] = 0.0
            d.turn_rate[row] = 0.0
        if in_place[row]:
            d.speed[row] = 0.0
