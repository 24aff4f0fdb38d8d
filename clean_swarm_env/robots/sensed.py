"""What goes into a `RobotProcess` and what comes out of it, in SI units and the frame of the mission's ground."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence, Set
from dataclasses import dataclass, field
from numbers import Integral, Real
from typing import Any, Final, NamedTuple, cast

import numpy as np

from selector.documents.plain import DocumentError, must_fit, short
from selforg.gradients.gradient import Gradient

NUMBERS_BELOW: Final = 1e15
"""Numbers below this are taken: clocks count periods exactly up to it."""
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


def is_finite(given: Any) -> bool:  # noqa: ANN401  (what a caller gives)
    """Return whether something is a number that is finite, and not absurdly large."""
    return isinstance(given, Real) and bool(-NUMBERS_BELOW < cast("float", given) < NUMBERS_BELOW)


def is_whole(given: object) -> bool:
    """Return whether something is a whole number from 0 on."""
    return isinstance(given, Integral) and not isinstance(given, bool) and int(given) >= 0


def is_flag(given: object) -> bool:
    """Return whether something is True or False."""
    return isinstance(given, bool | np.bool_)


def are_all(given: Any, fits: Callable[[Any], bool]) -> bool:  # noqa: ANN401
    """Return whether something is a tuple, list or array of what `fits`."""
    listed = isinstance(given, Collection) and not isinstance(given, str | Set | Mapping)
    return listed and all(fits(one) for one in given)


def is_place(given: Any) -> bool:  # noqa: ANN401  (what a caller gives)
    """Return whether something is two finite numbers."""
    return are_all(given, is_finite) and len(given) == 2


def are_items(given: object) -> bool:
    """Return whether something is items by their numbers."""
    return (
        isinstance(given, Mapping)
        and all(map(is_whole, given))
        and all(isinstance(one, SeenItem) and is_place(one[:2]) and is_flag(one[2]) for one in given.values())
    )


WIDEST: Final = 7.0
"""Largest heading [rad]: a turn, and room for its errors; beyond it is counted in degrees, or never wrapped."""
POSSIBLE: Final[Sequence[tuple[str, str, Callable[[Any], bool]]]] = (
    *((name, "a finite number", is_finite) for name in ("stamp", "x", "y")),
    ("heading", f"radians, from -{WIDEST:g} to {WIDEST:g}", lambda given: is_finite(given) and abs(given) <= WIDEST),
    ("collisions", "a whole number from 0 on", lambda given: is_whole(given) and is_finite(given)),
    ("near", "places (x, y)", lambda given: are_all(given, is_place)),
    ("items", "SeenItem by numbers from 0 on", are_items),
    ("cargo", "numbers of items from 0 on", lambda given: are_all(given, is_whole)),
    ("recycled", "True or False", is_flag),
)
"""Each field of `Sensed`, what is expected of it, and whether a value is that."""


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
    """Places of other bodies that it senses now [m], without knowing who they are.

    As in a mission two things read them: the rays of the sensor `Lidar` and of the term `lidar`, and a robot that backs
    off from what it has bumped into (`consequences.back_off`). Mechanisms avoid the robots that it hears, not these.
    """
    items: Mapping[int, SeenItem] = field(default_factory=dict)
    """Items that lie, by numbers that stay with them, from 0 on."""
    cargo: tuple[int, ...] = ()
    """The items that it carries, the last one picked first."""
    recycled: bool = False
    """Whether its cargo has been recycled."""

    def __post_init__(self) -> None:
        """Check each field, and that they fit together: sensors break."""
        for name, expected, is_possible in POSSIBLE:
            given = getattr(self, name)
            if not is_possible(given):
                raise DocumentError(f"sensed: {name}: expected {expected}, got {short(given)}")
        must_fit({*self.items}.isdisjoint(self.cargo), "sensed: cargo", "items that do not lie", self.cargo)
        must_fit(len(self.cargo) > 0 or not self.recycled, "sensed: recycled", "False without cargo", self.recycled)


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
