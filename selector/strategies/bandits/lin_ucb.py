"""Upper confidence bounds of rewards that are linear in the context."""

from selector.strategies.bandits.linear_model import LinearModel
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selforg.arrays import Ints


@STRATEGIES.register
class LinUCB(LinearModel):
    """LinUCB with disjoint models (Li, Chu, Langford & Schapire 2010, doi:10.1145/1772690.1772758, algorithm 1).

    The bound is expected reward + exploration * standard error; `exploration` is the paper's alpha.
    """

    def _select(self, decisions: Decisions) -> Ints:
        expected, error = self.predictions(decisions)
        return best(expected + self.parameters.exploration * error, decisions.allowed)
