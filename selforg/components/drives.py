"""Drive models: how a commanded vector becomes motion; pure functions over rows.

A robot that turns in place uses the direction of its vector only. A zero vector stands still.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats
from selforg.components.actions import Commands


@dataclass(frozen=True)
class DriveLimits:
    """Limits of a drive; all must be positive.

    Attributes:
        max_speed: [m/s].
        max_turn_rate: [rad/s].
        turn_gain: turn rate per heading error [1/s].
        turn_in_place_beyond: heading error from which on a differential drive only turns [rad].

    """

    max_speed: float = 1.0
    max_turn_rate: float = 2.0
    turn_gain: float = 2.0
    turn_in_place_beyond: float = math.pi / 3.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (value > 0.0 and math.isfinite(value)):
                raise ValueError(f"{name}: expected a positive number, got {value}")


def differential(commands: Commands, headings: Floats, limits: DriveLimits) -> tuple[Floats, Floats]:
    """Return speed (N,) [m/s] along the heading and turn rate (N,) [rad/s] towards the vector; headings (N,) [rad]."""
    length, error = _errors(commands, headings)
    ahead = ~commands.in_place & (np.abs(error) < limits.turn_in_place_beyond)
    speed = np.where(ahead, np.minimum(length, limits.max_speed), 0.0)
    return speed, _turn_rate(error, limits)


def holonomic(commands: Commands, headings: Floats, limits: DriveLimits) -> tuple[Floats, Floats]:
    """Return velocity (N, 2) [m/s] and turn rate (N,) [rad/s], which is 0 unless the robot turns in place."""
    length, error = _errors(commands, headings)
    moving = commands.commanded & ~commands.in_place
    shrink = np.where(length > limits.max_speed, limits.max_speed / np.maximum(length, limits.max_speed), 1.0)
    velocity = np.where(moving[:, None], commands.vectors * shrink[:, None], 0.0)
    return velocity, np.where(commands.in_place, _turn_rate(error, limits), 0.0)


def _errors(commands: Commands, headings: Floats) -> tuple[Floats, Floats]:
    """Length (N,) of the vectors, 0 without a command, and heading error (N,) in [-pi, pi), 0 for a zero vector."""
    length = np.where(commands.commanded, np.linalg.norm(commands.vectors, axis=1), 0.0)
    error = np.arctan2(commands.vectors[:, 1], commands.vectors[:, 0]) - headings
    wrapped = (error + math.pi) % (2.0 * math.pi) - math.pi
    return length, np.where(length > 0.0, wrapped, 0.0)


def _turn_rate(error: Floats, limits: DriveLimits) -> Floats:
    return np.clip(limits.turn_gain * error, -limits.max_turn_rate, limits.max_turn_rate)
