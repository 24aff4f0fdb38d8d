"""Time: the ticks of W worlds since their resets, and the clock that their buffers share."""

from __future__ import annotations

from typing import Annotated, Final, NamedTuple

import numpy as np

from selforg.arrays import CLOCKED, READ, SCRATCH, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Handle, Packed, opening
from selforg.program import AFTER_MOVING, Rows, Step

CLOCK_GRID: Final = 2.0**-30
"""Times of the buffers are multiples of this [s]: exact up to 2^23 s, and too long by 5e-9 at most."""


class Ticks(NamedTuple):
    """The control periods of a batch of worlds."""

    ticks: Annotated[Ints, "1", SCRATCH]  # of the batch; they go on through resets
    begun: Annotated[Ints, "W", READ]  # tick at which each world was reset


open_ticks = opening(Ticks)


class Clock:
    """Counts the control periods of a batch of worlds.

    Attributes:
        period: length of a control period [s].
        length: the same, as the buffers' times have it [s].
        packed: the record that compiled code takes.

    """

    _begun: Annotated[Ints, "W", CLOCKED]  # tick at which each world was reset

    def __init__(self, worlds: int, period: float) -> None:
        self.period = period
        # Floats hold times on this grid exactly, so sums of them need no rounding and an age does not depend on when
        # its world was reset. The step is rounded up, so that a period of whole ticks is over with its last tick.
        # See docs/decisions/0006-buffer-clock.md.
        self.length = float(np.ceil(period / CLOCK_GRID) * CLOCK_GRID)
        self._begun = np.zeros(worlds, dtype=np.int64)
        self.packed = Packed(Ticks(np.zeros(1, dtype=np.int64), self._begun))

    @property
    def tick(self) -> int:
        """Control periods of the batch; they go on through resets."""
        return int(self.packed.record.ticks[0])

    @property
    def now(self) -> float:
        """Time of the buffers [s]; it goes on through resets."""
        return self.tick * self.length

    @property
    def ticks(self) -> Ints:
        """Control periods (W,) since the reset of each world."""
        return self.tick - self._begun

    def reset(self, world: int) -> None:
        """Count the ticks of a world from now on."""
        self._begun[world] = self.tick

    def advancing(self) -> Step:
        """Return the step that counts one control period."""
        return Step(AFTER_MOVING, advance, Rows.of(self._begun[:0]), advance, (self.packed,), always=True)


@lean_kernel
def advance(now: float, rows: Ints, ticks: Handle[Ticks]) -> int:
    """Count one control period; a step, see `selforg.program`."""
    open_ticks(ticks).ticks[0] += 1
    return 0
