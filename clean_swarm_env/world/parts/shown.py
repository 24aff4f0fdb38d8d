"""What a task shows of itself: one declaration, read by recordings, pictures, the global state and rays.

Shapes: W worlds of N robots, R = W * N rows (robots), M things of a kind in each world.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.physics.rays import Bodies
from selforg.arrays import Flags, Ints

AnyArray = NDArray[Any]
Span = tuple[int, int]
"""Least and largest value."""
ROBOT, WORLD = "robot", "world"
SignName = Literal["item", "leftovers", "recycling", "dump"]
SIGNS: Final = get_args(SignName)
"""Names of the signs that tasks may draw; `drawing.look` says how they look."""
NO_END: Final = 1 << 30
"""Most that a range of `Drawn.where` has where it has no end."""


def in_span(values: AnyArray, span: Span) -> Flags:
    """Return which values lie within a span."""
    return values == span[0] if span[0] == span[1] else (values >= span[0]) & (values <= span[1])


class Shown(NamedTuple):
    """An array that a task shows, in which each robot, world or thing has an entry."""

    name: str
    axis: str
    """`robot`, `world`, or what the things are called: `item`."""
    values: AnyArray
    """Whole numbers (R,), (W,) or (W, M), or places (W, M, 2) [m]; the same array all the time if it is recorded."""
    about: str
    """One sentence."""
    parts: Mapping[str, AnyArray | Span] = {}
    """What the global state has beside x and y of places: name -> values of which that is 1, or numbers in [-1, 1]."""
    where: Mapping[str, Span] = {}
    """Name of a shown array -> values with which the global state has the places; others are 0."""
    names: Sequence[str] = ()
    """(M,) of the things in the global state; AXIS_0, AXIS_1 and so on unless given."""
    met: Bodies | None = None
    """What rays meet of it."""
    recorded: bool = True
    note: Callable[[], None] | None = None
    """Fills `values` before a frame of a recording; None: they are always up to date."""
    event: str = ""
    """What happens when a number goes up, such as `item brought`: recordings list it, their page has a line of it."""

    def __repr__(self) -> str:
        """Return name, axis and shape, for errors."""
        return f"{self.name}: {self.axis} {np.shape(self.values)}"


class Drawn(NamedTuple):
    """A sign that pictures draw for some of the things or robots that a task shows."""

    at: str
    """`Shown.axis` of things, whose places have the same name, or `robot` for a sign that is carried."""
    sign: SignName
    where: Mapping[str, Span] = {}
    """Name of a shown array -> values with which the sign is drawn."""
    numbers: Sequence[int] | None = None
    """Numbers of the things; None: all."""
    radius: float = 0.0
    """Of the area around each [m]."""

    def __repr__(self) -> str:
        """Return sign and place, for errors."""
        return f"{self.sign} at {self.at}"


class Destination(NamedTuple):
    """A place that robots go to: the nearest of some of the things that a task shows."""

    word: str
    at: str
    """`Shown.axis` of the things, whose places have the same name."""
    when: Mapping[str, bool]
    """Sensor of the robot -> whether it then reads more than 0."""
    where: Mapping[str, Span] = {}
    """As in `Drawn`."""
    numbers: Sequence[int] | None = None
    certain: bool = True
    """Whether the robot goes to the nearest of them; else nobody knows how far it is."""


def chosen_of(one: Drawn | Destination, values: Mapping[str, AnyArray], count: int) -> Ints:
    """Return the numbers (K,) of the things or robots, `count` in all, that are meant; `values` of a world by name."""
    flags: Flags = np.ones(count, dtype=np.bool_)
    for name, span in one.where.items():
        flags &= in_span(values[name], span)
    if one.numbers is not None:
        flags &= np.isin(np.arange(count), one.numbers)
    return np.flatnonzero(flags)
