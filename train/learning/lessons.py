"""Credit: the discounted rewards within a horizon after a decision, of a bandit or for a knowledge store.

Shapes: R rows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from selector.store import RewardSums
from selforg.arrays import Flags, Floats, Ints
from train.learning.config import CreditConfig


class Paid(NamedTuple):
    """K decisions whose rewards are complete."""

    rows: Ints
    options: Ints
    rewards: Floats
    contexts: Floats
    chances: Floats


class Credit:
    """Decisions that wait for their rewards.

    A decision gets the discounted rewards of the H periods that follow, or of fewer if the mission ends before. R rows,
    F components of a context.
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


class Ledger:
    """What the options of several goals brought, for a knowledge store: each choice is credited as a bandit's is.

    Args:
        options: goal -> names of its options.
        rows: R.
        period: time between two decisions [s].

    """

    def __init__(self, options: Mapping[str, Sequence[str]], rows: int, period: float) -> None:
        self._options, credit = options, CreditConfig()
        periods = max(round(credit.horizon / period), 1)
        self._credits = [Credit(rows, periods, 0, credit.discount**period) for _ in options]
        self._sums = [RewardSums(goal, names) for goal, names in options.items()]

    def note(self, options: Ints, chosen: Flags, rewards: Floats, over: Flags) -> None:
        """Note a period: `options` (R, G), which of them were `chosen` (R, G) anew, and what came of it (R,)."""
        for column, (credit, sums) in enumerate(zip(self._credits, self._sums, strict=True)):
            rows = np.flatnonzero(chosen[:, column])
            credit.decide(rows, options[rows, column], np.zeros((len(rows), 0)), np.ones(len(rows)))
            paid = credit.pay(rewards, over)
            sums.record(paid.options, paid.rewards)

    def taken(self) -> list[RewardSums]:
        """Return the sums since the last call, of goals that have some."""
        found = [sums for sums in self._sums if sums.count]
        self._sums = [RewardSums(goal, names) for goal, names in self._options.items()]
        return found
