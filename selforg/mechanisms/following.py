"""Following: all gradients, or the one that a rule chooses, by the potentials of Balch & Hybinette (2000)."""

from typing import Unpack

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.choosing import FARTHEST, LEAST_REACH, MOST_REACH, STRONGEST
from selforg.gradients.poses import OwnPoses
from selforg.mechanisms.base import RuleMechanism
from selforg.mechanisms.kernels.rules import AVOID_ALL, CHOICE, COLLISION, FOLLOW_ALL, FOLLOW_ONE
from selforg.mechanisms.options import SpeedOptions
from selforg.mechanisms.registry import MECHANISMS


@MECHANISMS.register
class CollisionAvoidance(RuleMechanism):
    """Away from all repulsive gradients; the others are ignored."""

    rule = COLLISION


@MECHANISMS.register
class FollowAll(RuleMechanism):
    """Towards attractive and away from repulsive gradients; neutral ones are ignored."""

    rule = FOLLOW_ALL


@MECHANISMS.register
class AvoidAll(RuleMechanism):
    """Away from all gradients, whatever their sign."""

    rule = AVOID_ALL


class FollowOne(RuleMechanism):
    """What the mechanisms share that follow one chosen gradient; `choice` is a rule of `selforg.gradients.choosing`."""

    rule = FOLLOW_ONE
    choice: int

    def __init__(self, buffer: SoBuffer | OwnPoses, **options: Unpack[SpeedOptions]) -> None:
        super().__init__(buffer, **options)
        self._parameters[CHOICE] = self.choice


@MECHANISMS.register
class FollowStrongest(FollowOne):
    """Towards (or away from) the strongest gradient: repulsions by their length, attractions by 1 - length."""

    choice = STRONGEST


@MECHANISMS.register
class FollowMin(FollowOne):
    """Towards the farthest attractive gradient: the one with the longest attraction."""

    choice = FARTHEST


@MECHANISMS.register
class FollowMinReach(FollowOne):
    """Towards the attractive gradient of least reach."""

    choice = LEAST_REACH


@MECHANISMS.register
class FollowMaxReach(FollowOne):
    """Towards the attractive gradient of most reach."""

    choice = MOST_REACH
