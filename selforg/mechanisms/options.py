"""Keyword arguments that many mechanisms share, so that subclasses need not repeat them."""

from collections.abc import Iterable
from typing import TypedDict

from selforg.randomness import DirectionStream


class LookOptions(TypedDict, total=False):
    """What a mechanism looks at; see `Mechanism`."""

    channels: Iterable[str]
    view_distance: float | None
    moving: bool
    static: bool


class MoveOptions(LookOptions, total=False):
    """What a movement mechanism looks at, and the source of its random directions; see `MovementMechanism`."""

    directions: DirectionStream | None


class SpeedOptions(MoveOptions, total=False):
    """The options of a movement mechanism, and the lengths of its vectors [m/s]; see `LimitedMechanism`."""

    min_speed: float
    max_speed: float
