"""Boids: what both flocking mechanisms share.

A boid is a row of a table, float64 (M, BOID_COLUMNS): its offset from the robot [m], its velocity [m/s] (Olfati-Saber)
or unit heading (Reynolds), its goal radius [m].
"""

from typing import ClassVar, Unpack

import numpy as np

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.mechanisms.base import MoveOptions
from selforg.mechanisms.formula import FormulaMechanism

BOID_OFFSET = 0  # and the two columns after it [m]
BOID_VELOCITY = 3  # and the two columns after it [m/s], or a heading [-]
BOID_GOAL_RADIUS = 6  # [m]
BOID_COLUMNS = 7


class FlockMechanism(FormulaMechanism):
    """What both flockings share: they look at the neighbours' moving gradients, by default those of the poses."""

    alone = True
    boid_columns = BOID_COLUMNS
    see_bits: ClassVar[int] = c.SEE_MOVING | c.SKIP_OWN

    def __init__(self, buffer: SoBuffer | OwnPoses, *, max_speed: float = 1.0, **options: Unpack[MoveOptions]) -> None:
        poses = buffer if isinstance(buffer, OwnPoses) else buffer.poses
        options["channels"] = tuple(options.get("channels", ())) or (poses.channel,)
        super().__init__(buffer, max_speed=max_speed, **options)
        self._see_bits = self.see_bits


def positive(mechanism: object, name: str, value: float) -> float:
    """Return `value` if it is positive and finite; raises ValueError with mechanism and parameter otherwise."""
    if not 0.0 < value < np.inf:
        raise ValueError(f"{type(mechanism).__name__}: {name} must be positive and finite, got {value!r}")
    return float(value)
