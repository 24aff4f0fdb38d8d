"""Strategies that do not learn: the highest score, as in the paper, and as yardsticks a fixed and a random option."""

from typing import Any

import numpy as np
from pydantic import Field

from selector.documents.fields import Label
from selector.strategies.choosing import best, chance_of, drawn, even
from selector.strategies.problem import Decisions, Problem
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints


@STRATEGIES.register
class MaxScore(DecisionStrategy):
    """The option of the highest score that can serve, the first of several; updates change nothing."""

    def _opinions(self, decisions: Decisions) -> Floats:
        return np.broadcast_to(self.problem.scores, decisions.allowed.shape)

    def _select(self, decisions: Decisions) -> Ints:
        return best(self._opinions(decisions), decisions.allowed)


@STRATEGIES.register
class Fixed(DecisionStrategy):
    """The same option in every decision."""

    option: Label = Field()
    """Name of the option to take wherever it can serve; elsewhere the option of the highest score is taken."""

    @classmethod
    def example(cls, problem: Problem) -> dict[str, Any]:
        """Return one of the options."""
        return {"option": problem.options[len(problem.options) // 2]}

    def _prepare(self) -> None:
        self.problem.check_options(f"strategy Fixed: goal {self.problem.goal}", (self.option,))
        self._order = self.problem.scores.copy()
        self._order[self.problem.options.index(self.option)] = np.inf

    def _opinions(self, decisions: Decisions) -> Floats:
        return np.isposinf(self._order).astype(np.float64)

    def _select(self, decisions: Decisions) -> Ints:
        return best(np.broadcast_to(self._order, decisions.allowed.shape), decisions.allowed)


@STRATEGIES.register
class Random(DecisionStrategy):
    """Every option that can serve, with equal probability; rewards change nothing."""

    draws_per_decision = 1

    def _opinions(self, decisions: Decisions) -> Floats:
        return even(decisions.allowed)

    def _select(self, decisions: Decisions) -> Ints:
        chances = even(decisions.allowed)
        option = drawn(chances, decisions.draws[:, 0])
        self.chance[decisions.rows] = chance_of(chances, option)
        return option
