"""The interface of the two ways in which a strategy can learn from its decisions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Ints
from train.learning.credit import Paid

Taker = Callable[[Paid, int], None]
"""Called with decisions whose rewards are complete, and the number of decisions made since the last call."""


class Learning(Protocol):
    """A way to learn: who decides when, and what each decision is rewarded for."""

    @property
    def teams(self) -> Ints:
        """(R,) team of each row of the strategy."""

    def learn(self, strategy: DecisionStrategy, checkpoint: int, take: Taker) -> list[float]:
        """Let the strategy decide and learn until the next checkpoint; return the costs of missions that ended [s]."""
