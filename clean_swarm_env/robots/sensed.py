"""What goes into a `RobotProcess` and what comes out of it, in SI units and the frame of the mission's ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import chain
from math import isfinite
from typing import NamedTuple, SupportsFloat

from selector.documents.errors import DocumentError
from selector.documents.plain import short
from selforg.gradients.gradient import Gradient

HANDLING = ("PickGarbage", "Recycle", "Dump")
"""What a robot does with items besides driving, by the names of its behaviours."""


class SeenItem(NamedTuple):
    """An item that lies where a robot sees it."""

    x: float
    """[m]."""
    y: float
    """[m]."""
    recycled: bool = False
    """Whether it has been at a recycling station already."""


@dataclass(frozen=True)
class Sensed:
    """What a robot senses by itself.

    The frame of the ground has its origin at the lower left corner; on open land at that of the whole ground.
    """

    stamp: float
    """When the pose was measured [s] since the mission began."""
    x: float
    """[m]."""
    y: float
    """[m]."""
    heading: float
    """[rad], 0 along x, counter-clockwise."""
    collisions: int = 0
    """Collisions since the last call, as a bumper notices them."""
    near: tuple[tuple[float, float], ...] = ()
    """Places of other bodies that it senses now [m], without knowing who they are."""
    items: Mapping[int, SeenItem] = field(default_factory=dict)
    """Items that lie, by numbers that stay with them, from 0 on."""
    cargo: tuple[int, ...] = ()
    """The items that it carries, the last one picked first."""
    recycled: bool = False
    """Whether its cargo has been recycled."""

    def __post_init__(self) -> None:
        """Check shapes, and that numbers are finite: sensors break."""
        if not all(len(place) == 2 for place in self.near):
            raise DocumentError(f"sensed: near: expected pairs, got {short(self)}")
        if not all(isinstance(one, SeenItem) for one in self.items.values()):
            raise DocumentError(f"sensed: items: expected SeenItem by number, got {short(self)}")
        if not all(isinstance(item, int) for item in (*self.items, *self.cargo)):
            raise DocumentError(f"sensed: cargo: expected numbers of items, got {short(self)}")
        numbers = self.stamp, self.x, self.y, self.heading, *chain(*self.near, *self.items.values())
        if not all(isinstance(number, SupportsFloat) and isfinite(number) for number in numbers):
            raise DocumentError(f"sensed: expected finite numbers, got {short(numbers)}")


class Wheels(NamedTuple):
    """What a robot is to do until the next call."""

    speed: float
    """Ahead [m/s]."""
    turn_rate: float
    """Counter-clockwise [rad/s]."""
    vector: tuple[float, float]
    """The movement that it wants [m/s], for robots that drive in any direction; zero where it does not move."""
    handles: tuple[str, ...] = ()
    """Those of HANDLING that it begins now."""
    stopped: str = ""
    """Why it stands by its own watchdog: `pose`, `link` or `clock`; empty if it does not."""


class Emitted(NamedTuple):
    """A gradient, and the buffer that it belongs to."""

    buffer: str
    """Name of the buffer; POSE_BUFFER for a pose."""
    gradient: Gradient


POSE_BUFFER = "poses"


@dataclass(frozen=True)
class Broadcast:
    """What a robot says to all that hear it, once in a control period."""

    robot: str
    """Who says it."""
    sequence: int
    """Counts its broadcasts since it began, from 0 on."""
    stamp: float
    """When it was said [s] since the mission began."""
    emitted: tuple[Emitted, ...] = ()
    """Its pose, and what it left since it said something last."""
