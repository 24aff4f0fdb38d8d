"""The interface of the two ways in which a strategy learns from its decisions."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints


class Paid(NamedTuple):
    """K decisions whose rewards are complete."""

    rows: Ints
    options: Ints
    rewards: Floats
    contexts: Floats
    chances: Floats


Taker = Callable[[Paid, int], None]
"""Function that gets decisions with complete rewards, and the number of decisions made since the last call."""


class Learning(Protocol):
    """A way of learning: when rows decide, and how each decision is rewarded."""

    @property
    def teams(self) -> Ints:
        """(R,) team of each row of the strategy."""

    def learn(self, strategy: DecisionStrategy, checkpoint: int, take: Taker) -> list[float]:
        """Train the strategy until the next checkpoint; return the costs of the missions that ended [s]."""
