"""Differential drive: a movement vector becomes a speed along the heading and a turn rate towards the vector."""

from collections.abc import Callable
from dataclasses import astuple, dataclass
from math import isfinite, pi
from typing import Final

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.physics.motion import wrapped_angle
from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import inlined, lean_kernel

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

CLOCK_TOLERANCE: Final = 1e-9  # [s]; sums of control periods miss a whole second by less than this


@dataclass(frozen=True)
class DriveSettings:
    """Limits and gain of the drive; values that make no sense raise ValueError."""

    max_speed: float = 1.0  # [m/s]
    max_turn_rate: float = 2.0  # [rad/s]
    turn_gain: float = 2.0  # [1/s], turn rate per heading error
    turn_in_place_beyond: float = pi / 3.0  # [rad] of heading error from which on the robot only turns
    command_timeout: float = 1.0  # [s] without a command after which a robot stops

    def __post_init__(self) -> None:
        for name in ("max_speed", "max_turn_rate", "turn_gain", "turn_in_place_beyond", "command_timeout"):
            if not (getattr(self, name) > 0.0 and isfinite(getattr(self, name))):
                raise ValueError(f"{name}: expected a positive number, got {getattr(self, name)}")


# speed (R,) [m/s], turn rate (R,) [rad/s], time of the last command (R,) [s], fields of DriveSettings (5,)
DRIVE_TABLES = Layout("f1", "f1", "f1", "f1")
drive_of: Callable[[Bundle], tuple[Floats, Floats, Floats, Floats]] = DRIVE_TABLES.unbundle


class DifferentialDrive:
    """Drives of R robots; a command holds until the next one, or until the robot has waited too long for it.

    speed: (R,) float64 [m/s] along the heading; the same array all the time, as Physics.substep takes it.
    turn_rate: (R,) float64 [rad/s]; the same array all the time.
    bundle: what `steer` takes of the drive.

    Impossible settings raise ValueError (see DriveSettings).

    >>> drive = DifferentialDrive(rows=2)
    >>> drive.command(np.array([[0.5, 0.0], [0.0, 2.0]]), np.array([True, True]), headings=np.zeros(2), now=0.0)
    >>> drive.speed.tolist(), drive.turn_rate.tolist()
    ([0.5, 0.0], [0.0, 2.0])
    """

    def __init__(
        self,
        rows: int,
        max_speed: float = 1.0,
        max_turn_rate: float = 2.0,
        turn_gain: float = 2.0,
        turn_in_place_beyond: float = pi / 3.0,
        command_timeout: float = 1.0,
    ) -> None:
        if rows < 1:
            raise ValueError(f"rows: expected at least 1, got {rows}")
        self.settings = DriveSettings(max_speed, max_turn_rate, turn_gain, turn_in_place_beyond, command_timeout)
        self.speed = np.zeros(rows)
        self.turn_rate = np.zeros(rows)
        self._nowhere = np.zeros(rows, np.bool_)
        self._commanded = np.zeros(rows)  # (R,) [s] time of the last command; of no meaning for a robot at rest
        self.bundle: Bundle = DRIVE_TABLES.bundle(
            self.speed, self.turn_rate, self._commanded, np.array(astuple(self.settings))
        )  # fmt: skip

    def command(
        self,
        vectors: NDArray[np.float64],
        has_command: NDArray[np.bool_],
        headings: NDArray[np.float64],
        now: float,
        in_place: NDArray[np.bool_] | None = None,
    ) -> None:
        """Take the commands of this instant and update `speed` and `turn_rate`.

        vectors (R, 2) [m/s] counts where has_command (R,) is set; headings (R,) [rad] in (-pi, pi]; now [s].
        A zero vector is a command to stand still. A robot whose last command is `command_timeout` old stops. Where
        `in_place` (R,) is set, a robot turns without driving.
        """
        steer(
            vectors, has_command, self._nowhere if in_place is None else in_place, headings, now, self.bundle
        )  # fmt: skip

    def reset(self, rows: NDArray[np.intp] | slice) -> None:
        """Stop these rows, as at the beginning."""
        self.speed[rows] = 0.0
        self.turn_rate[rows] = 0.0
        self._commanded[rows] = 0.0


@lean_kernel
def steer(vectors: Floats, has_command: Flags, in_place: Flags, headings: Floats, now: float, drive: Bundle) -> None:
    """Update what the drives do; see `DifferentialDrive.command`."""
    steer_rows(vectors, has_command, in_place, headings, now, drive)


@inlined
def steer_rows(
    vectors: Floats, has_command: Flags, in_place: Flags, headings: Floats, now: float, drive: Bundle
) -> None:
    """Do what `steer` does, in a kernel that does more."""
    speed, turn_rate, commanded, settings = drive_of(drive)
    max_speed, max_turn_rate, turn_gain = settings[0], settings[1], settings[2]
    turn_in_place_beyond, command_timeout = settings[3], settings[4]
    for row in range(speed.shape[0]):
        if has_command[row]:
            x, y = vectors[row, 0], vectors[row, 1]
            length = np.hypot(x, y)
            commanded[row] = now
            if length > 0.0:
                error = wrapped_angle(np.arctan2(y, x) - headings[row])
                turn_rate[row] = min(max(turn_gain * error, -max_turn_rate), max_turn_rate)
                speed[row] = min(length, max_speed) if abs(error) < turn_in_place_beyond else 0.0
            else:
                speed[row] = 0.0
                turn_rate[row] = 0.0
        elif now - commanded[row] > command_timeout - CLOCK_TOLERANCE:
            speed[row] = 0.0
            turn_rate[row] = 0.0
        if in_place[row]:
            speed[row] = 0.0
