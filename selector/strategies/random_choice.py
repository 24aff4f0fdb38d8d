"""Any option, all alike: the other end of what learned strategies have to beat."""

from selector.strategies.choosing import chance_of, drawn, even
from selector.strategies.problem import Decisions, Outcomes
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Ints


@STRATEGIES.register
class Random(DecisionStrategy):
    """Each option that can serve with the same probability; rewards change nothing."""

    @property
    def draws_per_decision(self) -> int:
        """Random numbers that one row takes for one decision."""
        return 1

    def _select(self, decisions: Decisions) -> Ints:
        chances = even(decisions.allowed)
        option = drawn(chances, decisions.draws[:, 0])
        self.chance[decisions.rows] = chance_of(chances, option)
        return option

    def _update(self, outcomes: Outcomes) -> None:
        pass  # nothing to learn
