"""Following: all gradients, or the one that a rule chooses, by the potentials of Balch & Hybinette (2000)."""

from selforg.mechanisms.base import RuleMechanism
from selforg.mechanisms.kernels.rules import (
    avoid_all,
    avoid_repulsive,
    follow_all,
    follow_farthest,
    follow_least_reach,
    follow_most_reach,
    follow_strongest,
)
from selforg.mechanisms.registry import MECHANISMS


@MECHANISMS.register
class CollisionAvoidance(RuleMechanism):
    """Away from all repulsive gradients; the others are ignored."""

    rule = avoid_repulsive


@MECHANISMS.register
class FollowAll(RuleMechanism):
    """Towards attractive and away from repulsive gradients; neutral ones alone are a movement of zero (B4)."""

    rule = follow_all


@MECHANISMS.register
class AvoidAll(RuleMechanism):
    """Away from all gradients, whatever their sign."""

    rule = avoid_all


@MECHANISMS.register
class FollowStrongest(RuleMechanism):
    """Towards (or away from) the strongest gradient: repulsions by their length, attractions by 1 - length."""

    rule = follow_strongest


@MECHANISMS.register
class FollowMin(RuleMechanism):
    """Towards the farthest attractive gradient: the one with the longest attraction."""

    rule = follow_farthest


@MECHANISMS.register
class FollowMinReach(RuleMechanism):
    """Towards the attractive gradient of least reach."""

    rule = follow_least_reach


@MECHANISMS.register
class FollowMaxReach(RuleMechanism):
    """Towards the attractive gradient of most reach."""

    rule = follow_most_reach
