"""The option of the highest score: by the expert, as in the paper, or learned before."""

import numpy as np

from selector.strategies.choosing import best
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Ints


@STRATEGIES.register
class MaxScore(DecisionStrategy):
    """The option of the highest score that can serve, the first of several; updates change nothing."""

    def _select(self, decisions: Decisions) -> Ints:
        return best(np.broadcast_to(self.problem.scores, decisions.allowed.shape), decisions.allowed)
