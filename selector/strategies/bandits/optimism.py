"""Upper confidence bounds: the choice that all strategies with such bounds make, and the bounds over recent rewards."""

from typing import ClassVar

import numpy as np

from selector.documents.fields import NonNegative
from selector.strategies.bandits.value_table import PriorParameters, weighted
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints
from selforg.elementary import logarithms


class RecentParameters(PriorParameters):
    """How wide the confidence bounds are."""

    exploration: NonNegative = 1.0
    """Range of the rewards, B of the paper [reward]."""
    confidence: NonNegative = 0.5
    """The paper's xi [-]; theory asks for more than 0.5."""


class RecentUCB(DecisionStrategy):
    """Upper confidence bounds over recent rewards, by Garivier & Moulines; subclasses keep `counts` and `totals`."""

    Parameters = RecentParameters
    parameters: RecentParameters
    width: ClassVar[float]
    """Factor of the bounds in the paper."""
    counts: Floats  # (G, O) weight of the rewards that count
    totals: Floats  # (G, O) weighted sum of these rewards

    def estimates(self) -> Floats:
        """Return the present estimate (G, O) of the reward of each option."""
        means = self.totals / np.where(self.counts > 0.0, self.counts, 1.0)
        return weighted(self.counts, means, self.parameters.prior, self.problem.scores)

    def _select(self, decisions: Decisions) -> Ints:
        settings = self.parameters
        width = self.width * settings.exploration * np.sqrt(settings.confidence)
        return most_promising(decisions, self.estimates(), self.counts + settings.prior, width, self.problem.scores)

    def _opinions(self, decisions: Decisions) -> Floats:
        return self.estimates()[decisions.groups]


def most_promising(decisions: Decisions, means: Floats, pulls: Floats, width: float, scores: Floats) -> Ints:
    """Return the option (K,) of the highest upper bound mean + width * sqrt(ln(sum of pulls) / pulls).

    Options never tried come first, by the expert's `scores` (O,), as the algorithms begin by trying each once.

    Args:
        decisions: K decisions.
        means: (G, O) estimated rewards.
        pulls: (G, O) number of trials, 0 or more, not necessarily whole.
        width: factor of the confidence interval.
        scores: (O,) the scores of the expert.

    """
    tried = pulls > 0.0
    total = pulls.sum(axis=1, keepdims=True)
    certainty = logarithms(np.maximum(total, 1.0)) / np.where(tried, pulls, 1.0)
    bounds = means + width * np.sqrt(certainty)
    untried = decisions.allowed & ~tried[decisions.groups]
    favourite = best(np.broadcast_to(scores, untried.shape), untried)
    return np.where(untried.any(axis=1), favourite, best(bounds[decisions.groups], decisions.allowed))
