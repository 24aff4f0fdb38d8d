"""Upper confidence bounds that forget gradually, for rewards that drift or jump."""

from typing import Annotated

import numpy as np
from pydantic import Field

from selector.documents.arrays import Arrays
from selector.documents.fields import NonNegative, Number
from selector.strategies.bandits.optimism import most_promising
from selector.strategies.bandits.value_table import PriorParameters, summed, weighted
from selector.strategies.problem import Decisions, Outcomes
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints


class DiscountedUCBParameters(PriorParameters):
    """How optimistic to be, and how fast to forget."""

    discount: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.99
    """Factor by which all earlier rewards lose weight at each step [-]."""
    exploration: NonNegative = 1.0
    """Range of the rewards, B of the paper [reward]."""
    confidence: NonNegative = 0.5
    """The paper's xi [-]; theory asks for more than 0.5."""


@STRATEGIES.register
class DiscountedUCB(DecisionStrategy):
    """Discounted UCB (Garivier & Moulines 2011, doi:10.1007/978-3-642-24412-4_16, algorithm 1).

    A step is one update in which a group has rewards, be they of one robot or of all, so that forgetting does not
    depend on the size of the team. The expert's scores are not forgotten.
    """

    Parameters = DiscountedUCBParameters
    parameters: DiscountedUCBParameters
    counts: Floats  # (G, O) discounted number of rewards
    totals: Floats  # (G, O) their discounted sum

    def _first_state(self) -> Arrays:
        shape = (self.groups, self.options)
        return {"counts": np.zeros(shape), "totals": np.zeros(shape)}

    def estimates(self) -> Floats:
        """Return what each option is worth now (G, O)."""
        means = self.totals / np.where(self.counts > 0.0, self.counts, 1.0)
        return weighted(self.counts, means, self.parameters.prior, self.problem.scores)

    def _select(self, decisions: Decisions) -> Ints:
        settings = self.parameters
        width = 2.0 * settings.exploration * np.sqrt(settings.confidence)
        return most_promising(decisions, self.estimates(), self.counts + settings.prior, width, self.problem.scores)

    def _update(self, outcomes: Outcomes) -> None:
        place = (outcomes.groups, outcomes.option)
        touched = np.unique(outcomes.groups)
        self.counts[touched] *= self.parameters.discount
        self.totals[touched] *= self.parameters.discount
        self.counts += summed(place, np.ones(len(outcomes.option)), self.counts.shape)
        self.totals += summed(place, outcomes.reward, self.totals.shape)
