"""What the two ways have in common in which a strategy can learn from its decisions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from selector.documents.errors import DocumentError
from selector.strategies.problem import Problem
from selector.strategies.strategy import DecisionStrategy
from selforg.registry import unknown
from train.learning.credit import Paid

Ints = NDArray[np.int64]
Taker = Callable[[Paid, int], None]
"""Is told of decisions whose rewards are complete, and how many more decisions have been made."""


class Learning(Protocol):
    """A way to learn: who decides when, and what each decision is rewarded for."""

    @property
    def teams(self) -> Ints:
        """(R,) team of each row of the strategy."""

    def learn(self, strategy: DecisionStrategy, checkpoint: int, take: Taker) -> list[float]:
        """Let the strategy decide and learn until the next checkpoint; return the costs of missions that ended [s]."""


def columns_of(problem: Problem, names: tuple[str, ...], what: str) -> Ints:
    """Return the places of components of an observation; an unknown one is a DocumentError."""
    for name in names:
        if name not in problem.features:
            raise DocumentError(f"{what}: {unknown('component', name, problem.features)}")
    return np.array([problem.features.index(name) for name in names], dtype=np.int64)
