"""A radio that loses, delays and repeats broadcasts, as one robot hears it."""

from __future__ import annotations

from operator import itemgetter
from typing import Final, NamedTuple

import numpy as np

from clean_swarm_env.robots.sensed import Broadcast

AFTER: Final = 0.2
"""Time after which a broadcast that comes twice comes again [s]."""


class Faults(NamedTuple):
    """What is wrong with a radio."""

    loss: float = 0.0
    """Share of broadcasts that a robot does not hear."""
    delay: float = 0.0
    """Time until it hears the others [s]."""
    twice: float = 0.0
    """Share of these that it hears once more, AFTER later."""


class BadReception:
    """Keeps broadcasts until a robot hears them; each robot draws for itself.

    >>> late = BadReception(Faults(delay=0.4), np.random.default_rng(1))
    >>> late.send(Broadcast("robot_1", sequence=0, stamp=1.0), now=1.0)
    >>> len(late.heard(now=1.2)), len(late.heard(now=1.5))
    (0, 1)

    """

    def __init__(self, faults: Faults, rng: np.random.Generator) -> None:
        self._faults, self._rng = faults, rng
        self._waiting: list[tuple[float, Broadcast]] = []  # when it is heard [s], and what

    def send(self, said: Broadcast, now: float) -> None:
        """Send a broadcast to the robot at `now` [s]."""
        loss, delay, twice = self._faults
        lost, again = self._rng.random(2) < (loss, twice)
        copies = 0 if lost else 1 + again
        self._waiting += [(now + delay + AFTER * copy, said) for copy in range(copies)]

    def heard(self, now: float) -> list[Broadcast]:
        """Return what the robot hears by `now` [s], in the order in which it arrives."""
        due = sorted((one for one in self._waiting if one[0] <= now), key=itemgetter(0))
        self._waiting = [one for one in self._waiting if one[0] > now]
        return [said for _, said in due]
