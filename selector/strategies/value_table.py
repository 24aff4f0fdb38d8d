"""What strategies without a context know: how often each option was rewarded, with what mean and spread."""

from typing import Annotated

import numpy as np
from pydantic import Field

from selector.decisions import Floats, Outcomes
from selector.documents import Closed, NonNegative
from selector.strategy import Arrays, DecisionStrategy

Pseudocount = Annotated[NonNegative, Field(le=1e12)]


class PriorParameters(Closed):
    """How far the expert is believed."""

    prior: Pseudocount = 1.0
    """Pseudo-count: the expert's score of an option counts as this many rewards of that size [rewards]."""


class ValueTable(DecisionStrategy):
    """Count, mean and spread of the rewards of each option, in each group."""

    Parameters = PriorParameters
    parameters: PriorParameters
    counts: Floats  # (G, O) rewards
    means: Floats  # (G, O) of the rewards
    spreads: Floats  # (G, O) sum of squared deviations from the mean

    def _first_state(self) -> Arrays:
        shape = (self.groups, self.options)
        return {"counts": np.zeros(shape), "means": np.zeros(shape), "spreads": np.zeros(shape)}

    def pulls(self) -> Floats:
        """Return how often each option was tried (G, O), the pseudo-count included."""
        return self.counts + self.parameters.prior

    def estimates(self) -> Floats:
        """Return what each option is worth (G, O): the mean of its rewards and of the expert's score."""
        return weighted(self.counts, self.means, self.parameters.prior, self.problem.scores)

    def _update(self, outcomes: Outcomes) -> None:
        """Merge the batch, as Chan, Golub and LeVeque (1983) merge samples (doi:10.1080/00031305.1983.10483115)."""
        place, slots = outcomes.groups * self.options + outcomes.option, self.groups * self.options
        added = np.bincount(place, minlength=slots)
        touched = np.flatnonzero(added)
        new = added[touched]
        mean = np.bincount(place, outcomes.reward, slots)[touched] / new
        centre = np.zeros(slots)
        centre[touched] = mean
        spread = np.bincount(place, (outcomes.reward - centre[place]) ** 2, slots)[touched]
        counts, means, spreads = (array.reshape(-1) for array in (self.counts, self.means, self.spreads))
        old, total = counts[touched], counts[touched] + new
        step = mean - means[touched]
        means[touched] += step * (new / total)
        spreads[touched] += spread + step * step * (old * new / total)
        counts[touched] = total


def weighted(counts: Floats, means: Floats, prior: float, scores: Floats) -> Floats:
    """Return means (G, O) with `scores` (O,) as `prior` further rewards; the scores alone where there is no reward."""
    total = counts + prior
    known = total > 0.0
    with np.errstate(over="ignore", under="ignore"):
        values = (counts * means + prior * scores) / np.where(known, total, 1.0)
    return np.where(known, values, scores)
