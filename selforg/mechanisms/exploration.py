"""Exploration and exploitation: the two movements between which a forager decides."""

from typing import Unpack

import numpy as np

from selforg.compiler.decorators import part
from selforg.compiler.records import Handle, Written
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.pair import Own, Pair
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store.records import Poses, Sight, Store
from selforg.mechanisms.base import MECHANISMS, SpeedOptions
from selforg.mechanisms.chemotaxis import attraction_ge
from selforg.mechanisms.formula import FormulaMechanism
from selforg.mechanisms.movement import NOT_AT_ALL, REFLECT, Rule, open_rule
from selforg.parameters import at_least
from selforg.randomness import next_direction


@MECHANISMS.register
class Exploration(FormulaMechanism):
    """A random direction, at 1 m/s within [`min_speed`, `max_speed`] (B7), for every row that knows its pose."""

    looks = (NOT_AT_ALL, NOT_AT_ALL, NOT_AT_ALL)
    walls = REFLECT
    min_speed = 0.1

    @staticmethod
    @part
    def combine(
        row: int,
        found: int,
        own: Own,
        sight: Handle[Sight],
        rule: Written[Rule],
        poses: Handle[Poses],
        store: Handle[Store],
    ) -> bool:
        """Look at no gradient: the sum is a random direction of 1 m/s."""
        m = open_rule(rule)
        m.total[0], m.total[1], m.total[2] = next_direction(m.directions, m.cursor, m.low, row)
        return True


@MECHANISMS.register
class Exploitation(FormulaMechanism):
    """Ge & Cui attraction to all static gradients ahead, whatever their sign (Q14).

    angle_xy, angle_yz: view angles [rad] to either side of the heading, in the x-y and the y-z plane.
    """

    min_speed = 0.5

    @staticmethod
    def formula(pair: Pair) -> float:
        """Return the attraction of a pair, whatever the sign of the gradient [m]."""
        return attraction_ge(pair)

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        angle_xy: float = 1.3,
        angle_yz: float = np.pi,
        **options: Unpack[SpeedOptions],
    ) -> None:
        options = {"moving": False, **options}
        super().__init__(buffer, **options)
        self.angle_xy = at_least(self, "angle_xy", angle_xy, 0.0)
        self.angle_yz = at_least(self, "angle_yz", angle_yz, 0.0)
