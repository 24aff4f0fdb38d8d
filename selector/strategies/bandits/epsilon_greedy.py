"""Epsilon-greedy: the best option so far, or any option with a small probability."""

import numpy as np

from selector.documents.fields import NonNegative, Share
from selector.strategies.bandits.value_table import PriorParameters, ValueTable
from selector.strategies.choosing import best, chance_of, drawn, even
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selforg.arrays import Ints
from selforg.elementary import exponentials


class EpsilonGreedyParameters(PriorParameters):
    """How often to explore."""

    epsilon: Share = 0.1
    """Probability of taking any option that can serve, each with equal probability [-]."""
    decay: NonNegative = 0.0
    """Rate at which this probability falls, as epsilon * exp(-decay * number of rewards) [1/reward]."""


@STRATEGIES.register
class EpsilonGreedy(ValueTable):
    """Epsilon-greedy (Auer, Cesa-Bianchi & Fischer 2002, doi:10.1023/A:1013689704352, section 2)."""

    Parameters = EpsilonGreedyParameters
    parameters: EpsilonGreedyParameters

    @property
    def draws_per_decision(self) -> int:
        """Random numbers that one row takes for one decision: whether to explore, and what."""
        return 2

    def _select(self, decisions: Decisions) -> Ints:
        rewards = self.counts.sum(axis=1)
        epsilon = (self.parameters.epsilon * exponentials(-self.parameters.decay * rewards))[decisions.groups]
        greedy = best(self.estimates()[decisions.groups], decisions.allowed)
        anything = even(decisions.allowed)
        option = np.where(decisions.draws[:, 0] < epsilon, drawn(anything, decisions.draws[:, 1]), greedy)
        self.chance[decisions.rows] = epsilon * chance_of(anything, option) + (1.0 - epsilon) * (option == greedy)
        return option
