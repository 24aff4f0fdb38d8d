"""Any option with equal probability: a yardstick for strategies that learn."""

from selector.strategies.choosing import chance_of, drawn, even
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints


@STRATEGIES.register
class Random(DecisionStrategy):
    """Every option that can serve, with equal probability; rewards change nothing."""

    @property
    def draws_per_decision(self) -> int:
        """Random numbers that one row takes for one decision."""
        return 1

    def _opinions(self, decisions: Decisions) -> Floats:
        return even(decisions.allowed)

    def _select(self, decisions: Decisions) -> Ints:
        chances = even(decisions.allowed)
        option = drawn(chances, decisions.draws[:, 0])
        self.chance[decisions.rows] = chance_of(chances, option)
        return option
