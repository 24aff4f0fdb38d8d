"""Names of the array types, so that signatures say which numbers an array holds."""

from collections.abc import Iterable
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Ints: TypeAlias = npt.NDArray[np.int64]
Links: TypeAlias = npt.NDArray[np.int32]
Flags: TypeAlias = npt.NDArray[np.bool_]


class Lasting(NamedTuple):
    """What rows hand on from one tick to the next: arrays (R, ...), always the same ones."""

    values: tuple[npt.NDArray[Any], ...] = ()
    times: tuple[Floats, ...] = ()
    """Those that hold times of the clock [s]: rows that go on at another time take them along."""


def together(parts: Iterable[Lasting]) -> Lasting:
    """Return what several parts hand on."""
    found = tuple(parts)
    return Lasting(
        tuple(array for part in found for array in part.values), tuple(array for part in found for array in part.times)
    )
