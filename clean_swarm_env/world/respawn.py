"""Respawn of garbage: the items that arrive during a mission.

They arrive as a Poisson process. An item arrives when the number expected since the last arrival reaches an exponential
draw. So a change of the rate keeps the waiting time that has passed.
"""

from collections.abc import Iterator
from math import ceil
from typing import Final

import numpy as np

from selforg.arrays import Floats

NO_TICK: Final = 1 << 62
"""Tick of an event that never happens."""


class Arrivals:
    """The times and places at which items arrive in one world.

    Attributes:
        due: tick of the next arrival.

    """

    def __init__(self, rng: np.random.Generator, rate: float, ticks_per_minute: float) -> None:
        self._rng = rng
        self._ticks_per_minute = ticks_per_minute
        self._expected = float(rng.exponential())  # number of items expected until the next one arrives
        self._count_from(0.0, rate)

    def until(self, tick: int) -> Iterator[Floats]:
        """Yield the place of each item that has arrived by `tick`, (2,) shares of the world's extent."""
        while self.due <= tick:
            yield self._rng.uniform(size=2)
            self._expected = float(self._rng.exponential())
            self._count_from(self._next_time, self._rate)

    def set_rate(self, rate: float, tick: int) -> None:
        """Change the rate to `rate` [1/min] from `tick` on."""
        passed = (tick - self._since) * self._rate / self._ticks_per_minute
        self._expected = max(self._expected - passed, 0.0)
        self._count_from(float(tick), rate)

    def _count_from(self, since: float, rate: float) -> None:
        """Compute the next arrival at `rate` [1/min]; the expected items count from the time `since` [ticks]."""
        self._rate, self._since = rate, since
        self._next_time = since + self._expected * self._ticks_per_minute / rate if rate > 0.0 else float(NO_TICK)
        self.due = ceil(self._next_time)
