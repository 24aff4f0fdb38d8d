"""Array types, and the marks KEPT, CLOCKED, SCRATCH, READ and OUTSIDE, which say what becomes of an array.

A class declares its arrays by type, shape and mark; `selforg.declared` finds all that is declared below an object:

    class Flock:
        places: Annotated[Floats, "W sheep 2", KEPT]  # [m]
        fled_at: Annotated[Floats, "W sheep", CLOCKED]  # time of the clock [s]
        distances: Annotated[Floats, "W sheep", SCRATCH]  # [m]
        terrain: Annotated[Floats, "lines columns", READ]  # [m]

The first letter of what is kept says whose it is: W one entry for each world, R or N one for each robot of all worlds.
"""

from typing import Annotated, Any, Final, NamedTuple, TypeAlias, get_args, get_origin

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Ints: TypeAlias = npt.NDArray[np.int64]
Links: TypeAlias = npt.NDArray[np.int32]
Flags: TypeAlias = npt.NDArray[np.bool_]
Octets: TypeAlias = npt.NDArray[np.uint8]


class Mark(NamedTuple):
    """What becomes of a declared array or list; use one of the marks below."""

    name: str
    columns: tuple[int, ...] = ()
    """Those of the last axis that hold times; without any, all entries do."""
    unknown: float = 0
    """What is written where a state is put in."""


KEPT: Final = Mark("kept")
"""Goes on from one tick to the next: part of every state. Compiled code may write it."""
CLOCKED: Final = Mark("clocked")
"""Kept, and holds times of the clock, in seconds or, as whole numbers, in ticks: a state takes them along."""
SCRATCH: Final = Mark("scratch")
"""Overwritten before it is read in each tick: no part of a state."""
READ: Final = Mark("read")
"""Only read here: settings, models, and what another class keeps."""
OUTSIDE: Final = Mark("outside")
"""No part of the worlds: recorders, files, objects of the user."""


def clocked(*columns: int) -> Mark:
    """Return the mark of a table that is kept, whose `columns` hold times of the clock."""
    return Mark("clocked", columns)


def derived(unknown: float) -> Mark:
    """Return the mark of what follows from the rest, and is computed again where it has the value `unknown`.

    That value is written where a state is put in.
    """
    return Mark("derived", unknown=unknown)


def scalar_of(hint: Any) -> type:  # noqa: ANN401  (a type hint)
    """Return the type of the numbers in an array type, with or without declaration."""
    scalar = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    while inner := get_args(scalar):  # numpy.ndarray[shape, dtype[scalar]], or NDArray[scalar] since NumPy 2.5
        scalar = inner[-1]
    found: type = scalar
    return found


class Within(NamedTuple):
    """Bounds of indices, beside the mark: a state with others is refused."""

    least: int
    axis: str
    """The letter of an axis of the same class: indices are less than its length."""
