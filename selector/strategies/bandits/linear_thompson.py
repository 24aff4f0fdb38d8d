"""Thompson sampling with rewards that are linear in the context."""

import numpy as np

from selector.strategies.bandits.linear_model import LinearModel
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selector.strategies.streams import normals
from selforg.arrays import Ints


@STRATEGIES.register
class LinearThompson(LinearModel):
    """Thompson sampling with linear rewards (Agrawal & Goyal 2013, doi:10.48550/arXiv.1209.3352, algorithm 1).

    The paper draws the weights of each option. Only their product with the context counts, which is normal with the
    expected reward as mean and exploration * standard error as deviation; so this product is drawn. `exploration` is
    the paper's v, at least the standard deviation of the noise of the rewards.
    """

    @property
    def draws_per_decision(self) -> int:
        """Random numbers that one row takes for one decision: two for each option."""
        return 2 * self.options

    def _select(self, decisions: Decisions) -> Ints:
        expected, error = self.predictions(decisions)
        deviates = np.empty_like(expected)
        normals(decisions.draws, deviates)
        return best(expected + self.parameters.exploration * error * deviates, decisions.allowed)
