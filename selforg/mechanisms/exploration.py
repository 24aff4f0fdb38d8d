"""Exploration and exploitation: the two movements between which a forager decides."""

from typing import Unpack

import numpy as np

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.mechanisms.base import RuleMechanism, at_least
from selforg.mechanisms.kernels.rules import exploit, wander
from selforg.mechanisms.options import SpeedOptions
from selforg.mechanisms.registry import MECHANISMS


@MECHANISMS.register
class Exploration(RuleMechanism):
    """A random direction, at 1 m/s within [`min_speed`, `max_speed`] (B7), for every row that knows its pose."""

    rule = wander


@MECHANISMS.register
class Exploitation(RuleMechanism):
    """Ge & Cui attraction to all static gradients ahead, whatever their sign (Q14).

    angle_xy, angle_yz: view angles [rad] to either side of the heading, in the x-y and the y-z plane.
    """

    rule = exploit

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        angle_xy: float = 1.3,
        angle_yz: float = np.pi,
        **options: Unpack[SpeedOptions],
    ) -> None:
        options = {"min_speed": 0.5, "moving": False, **options}
        super().__init__(buffer, **options)
        self.angle_xy = at_least(self, "angle_xy", angle_xy, 0.0)
        self.angle_yz = at_least(self, "angle_yz", angle_yz, 0.0)
