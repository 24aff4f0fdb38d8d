"""Upper confidence bounds, for rewards that do not change."""

import numpy as np

from selector.documents.fields import NonNegative
from selector.strategies.bandits.optimism import most_promising
from selector.strategies.bandits.value_table import PriorParameters, ValueTable
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selforg.arrays import Ints


class UCB1Parameters(PriorParameters):
    """How wide the confidence bounds are."""

    exploration: NonNegative = 1.0
    """Factor of the confidence interval [reward]; the range of the rewards gives the interval of the paper."""


@STRATEGIES.register
class UCB1(ValueTable):
    """UCB1 (Auer, Cesa-Bianchi & Fischer 2002, doi:10.1023/A:1013689704352, figure 1).

    The bound of option i is mean_i + exploration * sqrt(2 ln n / n_i), n being the sum of all n_i.
    """

    Parameters = UCB1Parameters
    parameters: UCB1Parameters

    def _select(self, decisions: Decisions) -> Ints:
        pulls, width = self.counts + self.parameters.prior, self.parameters.exploration * np.sqrt(2.0)
        return most_promising(decisions, self.estimates(), pulls, width, self.problem.scores)
