"""What the two ways have in common in which a strategy can learn from its decisions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Ints
from train.learning.credit import Paid

Taker = Callable[[Paid, int], None]
"""Takes decisions whose rewards are complete, and how many more decisions have been made."""


class Learning(Protocol):
    """A way to learn: who decides when, and what each decision is rewarded for."""

    @property
    def teams(self) -> Ints:
        """(R,) team of each row of the strategy."""

    def learn(self, strategy: DecisionStrategy, checkpoint: int, take: Taker) -> list[float]:
        """Let the strategy decide and learn until the next checkpoint; return the costs of missions that ended [s]."""
