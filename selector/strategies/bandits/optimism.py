"""Optimism in the face of uncertainty: the part that the strategies with upper confidence bounds have in common."""

import numpy as np

from selector.strategies.choosing import best
from selector.strategies.problem import Decisions
from selforg.arrays import Floats, Ints


def most_promising(decisions: Decisions, means: Floats, pulls: Floats, width: float, scores: Floats) -> Ints:
    """Return the option (K,) of the highest upper bound mean + width * sqrt(ln(sum of pulls) / pulls).

    Options never tried come first, by the expert's `scores` (O,), as the algorithms begin by trying each once.

    Args:
        decisions: K decisions.
        means: (G, O) estimates.
        pulls: (G, O) how often each option was tried, 0 or more, not necessarily whole.
        width: factor of the confidence interval.
        scores: (O,) the expert's scores.

    """
    tried = pulls > 0.0
    total = pulls.sum(axis=1, keepdims=True)
    certainty = np.log(np.maximum(total, 1.0)) / np.where(tried, pulls, 1.0)
    bounds = means + width * np.sqrt(certainty)
    untried = decisions.allowed & ~tried[decisions.groups]
    favourite = best(np.broadcast_to(scores, untried.shape), untried)
    return np.where(untried.any(axis=1), favourite, best(bounds[decisions.groups], decisions.allowed))
