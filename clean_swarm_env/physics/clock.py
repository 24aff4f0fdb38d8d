"""Time: the ticks of W worlds since their resets, and the clock that their buffers share."""

from __future__ import annotations

from typing import Annotated, Final

import numpy as np

from selforg.arrays import CLOCKED, Ints

CLOCK_GRID: Final = 2.0**-30
"""Times of the buffers are multiples of this [s]: exact up to 2^23 s, and too long by 5e-9 at most."""


class Clock:
    """Counts the control periods of a batch of worlds.

    Attributes:
        period: length of a control period [s].
        tick: control periods of the batch; it goes on through resets.

    """

    _begun: Annotated[Ints, "W", CLOCKED]  # tick at which each world was reset

    def __init__(self, worlds: int, period: float) -> None:
        self.period = period
        self.tick = 0
        # Floats hold times on this grid exactly, so sums of them need no rounding and an age does not depend on when
        # its world was reset. The step is rounded up, so that a period of whole ticks is over with its last tick.
        # See docs/decisions/0006-buffer-clock.md.
        self._step = float(np.ceil(period / CLOCK_GRID) * CLOCK_GRID)
        self._begun = np.zeros(worlds, dtype=np.int64)

    @property
    def now(self) -> float:
        """Time of the buffers [s]; it goes on through resets."""
        return self.tick * self._step

    @property
    def ticks(self) -> Ints:
        """Control periods (W,) since the reset of each world."""
        return self.tick - self._begun

    def reset(self, world: int) -> None:
        """Count the ticks of a world from now on."""
        self._begun[world] = self.tick

    def advance(self) -> None:
        """Count one control period."""
        self.tick += 1
