"""Selection of the option that each coordinator of each robot holds, in every decision period."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from selector.coordination.coordinator import Coordinator
from selector.strategies.registry import StrategySpec
from selector.strategies.streams import row_keys
from selforg.arrays import Floats, Ints

BY_SCORE = StrategySpec(name="MaxScore")
"""The strategy of the paper: the highest score of the expert."""


class Selection:
    """One strategy for each of C coordinators over the same R rows.

    Args:
        coordinators: the coordinators whose options are chosen.
        seed: of all random numbers; rows draw independently of each other.
        spec: the strategy.

    """

    def __init__(self, coordinators: Sequence[Coordinator], seed: int, spec: StrategySpec = BY_SCORE) -> None:
        self.rows = len(coordinators[0].held)
        self.strategies = tuple(
            spec.build(
                coordinator.model.problem,
                row_keys(np.random.SeedSequence([seed, c]), self.rows),
                np.zeros(self.rows, dtype=np.int64),
            )
            for c, coordinator in enumerate(coordinators)
        )
        self._context = np.zeros((self.rows, 0))

    def decide(self) -> Ints:
        """Return the option (R, C) that each row is to hold of each coordinator until the next decision."""
        return np.stack([strategy.select(self._context) for strategy in self.strategies], axis=1)

    def opinions(self) -> tuple[Floats, ...]:
        """Return what each row thinks of the options (R, O) of each coordinator."""
        return tuple(strategy.opinions(self._context) for strategy in self.strategies)
