"""Upper confidence bounds over discounted rewards, for rewards that drift or jump."""

from typing import Annotated

import numpy as np
from pydantic import Field

from selector.documents.arrays import Arrays
from selector.documents.fields import Number
from selector.strategies.bandits.optimism import RecentParameters, RecentUCB
from selector.strategies.bandits.value_table import summed
from selector.strategies.problem import Outcomes
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import LEARNED_LIMIT


class DiscountedUCBParameters(RecentParameters):
    """How wide the bounds are, and how fast rewards lose weight."""

    discount: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.99
    """Factor by which all earlier rewards lose weight at each step [-]."""


@STRATEGIES.register
class DiscountedUCB(RecentUCB):
    """Discounted UCB (Garivier & Moulines 2011, doi:10.1007/978-3-642-24412-4_16, algorithm 1).

    A step is one update with rewards of any number of robots of a group, so that the discount does not depend on the
    size of the team. The scores of the expert are not discounted.
    """

    Parameters = DiscountedUCBParameters
    parameters: DiscountedUCBParameters
    width = 2.0

    def _first_state(self) -> Arrays:
        shape = (self.groups, self.options)
        return {"counts": np.zeros(shape), "totals": np.zeros(shape)}

    def _ranges(self) -> dict[str, tuple[float, float]]:
        return {"counts": (0.0, LEARNED_LIMIT)}

    def _update(self, outcomes: Outcomes) -> None:
        place = (outcomes.groups, outcomes.option)
        touched = np.unique(outcomes.groups)
        self.counts[touched] *= self.parameters.discount
        self.totals[touched] *= self.parameters.discount
        self.counts += summed(place, np.ones(len(outcomes.option)), self.counts.shape)
        self.totals += summed(place, outcomes.reward, self.totals.shape)
