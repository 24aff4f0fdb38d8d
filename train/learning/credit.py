"""Credit of rewards to the decisions of a bandit: the discounted rewards within a horizon.

Shapes: R rows, H decision periods of the horizon, F components of a context.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from selforg.arrays import Flags, Floats, Ints


class Paid(NamedTuple):
    """K decisions whose rewards are complete."""

    rows: Ints
    options: Ints
    rewards: Floats
    contexts: Floats
    chances: Floats


class Credit:
    """Decisions that wait for their rewards.

    A decision gets the discounted rewards of the H periods that follow, or of fewer if the mission ends before.
    """

    def __init__(self, rows: int, periods: int, features: int, discount: float) -> None:
        """`periods` is H, `discount` the weight of a reward one period later."""
        self._discount = discount
        self._place = 0
        self._waits = np.zeros((periods, rows), dtype=np.bool_)
        self._options = np.zeros((periods, rows), dtype=np.int64)
        self._sums = np.zeros((periods, rows))
        self._weights = np.ones((periods, rows))
        self._chances = np.ones((periods, rows))
        self._contexts = np.zeros((periods, rows, features))

    def decide(self, rows: Ints, options: Ints, contexts: Floats, chances: Floats) -> None:
        """Note the `options` (K,) that `rows` (K,) chose for the period that begins."""
        place = self._place
        self._waits[place, rows] = True
        self._options[place, rows], self._chances[place, rows] = options, chances
        self._contexts[place, rows] = contexts
        self._sums[place, rows], self._weights[place, rows] = 0.0, 1.0

    def pay(self, rewards: Floats, over: Flags) -> Paid:
        """Add the `rewards` (R,) of a period, after which missions may be `over` (R,); return complete decisions."""
        self._sums += self._weights * rewards
        self._weights *= self._discount
        self._place = (self._place + 1) % len(self._waits)
        complete = self._waits & over
        complete[self._place] |= self._waits[self._place]  # its place is needed next
        places, rows = np.nonzero(complete)
        self._waits[places, rows] = False
        return Paid(
            rows=rows,
            options=self._options[places, rows],
            rewards=self._sums[places, rows],
            contexts=self._contexts[places, rows],
            chances=self._chances[places, rows],
        )
