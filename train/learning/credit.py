"""Credit: the discounted rewards within a horizon after a decision, of a bandit or for a knowledge store.

Shapes: R rows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from train.learning.config import CreditConfig


class Paid(NamedTuple):
    """K decisions whose rewards are complete, as `DecisionStrategy.update` takes them."""

    options: Ints
    rewards: Floats
    contexts: Floats
    rows: Ints
    chances: Floats


class Credit:
    """Decisions that wait for their rewards.

    A decision gets the discounted rewards of the H periods that follow, or of fewer if the mission ends before. R rows,
    F components of a context.

    Args:
        settings: the horizon, and the discount of a second.
        period: time between two decisions [s].
        rows: R.
        features: F.

    """

    def __init__(self, settings: CreditConfig, period: float, rows: int, features: int = 0) -> None:
        self._discount = settings.discount**period
        self._place, shape = 0, (max(round(settings.horizon / period), 1), rows)
        self._waits = np.zeros(shape, dtype=np.bool_)
        self._options = np.zeros(shape, dtype=np.int64)
        self._sums, self._weights, self._chances = np.zeros(shape), np.ones(shape), np.ones(shape)
        self._contexts = np.zeros((*shape, features))

    def decide(self, rows: Ints, options: Ints, contexts: Floats | float = 0.0, chances: Floats | float = 1.0) -> None:
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
        done = np.nonzero(complete)
        self._waits[done] = False
        return Paid(self._options[done], self._sums[done], self._contexts[done], done[1], self._chances[done])
