"""Exponential weights, for rewards that need not follow any distribution."""

from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, Field, ValidationInfo

from selector.documents.arrays import Arrays
from selector.documents.fields import NonNegative, Number
from selector.strategies.choosing import chance_of, drawn, even, shares
from selector.strategies.problem import Decisions, Outcomes, Problem
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints


def _above_lowest(highest: float, given: ValidationInfo) -> float:
    lowest = given.data.get("lowest", -np.inf)
    if not lowest < highest:
        raise ValueError(f"expected more than the lowest reward {lowest}, got {highest}")
    return highest


@STRATEGIES.register
class EXP3(DecisionStrategy):
    """EXP3 (Auer, Cesa-Bianchi, Freund & Schapire 2002, doi:10.1137/S0097539701398375, figure 1).

    Weights are kept as logarithms, whose largest is 0, so that they never overflow. The same formula is used for the
    options that can serve if others cannot. A hundred robots that learn together soon take the better option, and go on
    to try the other in a share `gamma` / 2 of decisions:

    >>> import numpy as np
    >>> from selector.strategies.registry import create
    >>> problem = Problem("AvoidCollision", ("ORCA", "Off"), np.array([0.5, 1.0]))
    >>> strategy = create("EXP3", problem, np.arange(100, dtype=np.uint64), {"gamma": 0.1})
    >>> for _ in range(100):
    ...     option = strategy.select(np.zeros((100, 0)))
    ...     strategy.update(option, np.where(option == 0, 0.8, 0.3), np.zeros((100, 0)))
    >>> np.bincount(strategy.select(np.zeros((100, 0)))), round(float(strategy.chance[0]), 3)
    (array([96,  4]), 0.95)

    """

    gamma: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.1
    """Share of decisions in which any option is taken, with equal probability; also the step of the weights [-]."""
    lowest: Number = 0.0
    """Reward that counts as 0, as do lower ones [reward]."""
    highest: Annotated[Number, AfterValidator(_above_lowest), Field(validate_default=True)] = 1.0
    """Reward that counts as 1, as do higher ones [reward]."""
    prior: NonNegative = 1.0
    """Pseudo-count: the score of each option counts as this many rewards at the beginning [rewards]."""
    draws_per_decision = 1
    log_weights: Floats  # (G, O)

    @classmethod
    def example(cls, problem: Problem) -> dict[str, Any]:
        """Return a range of rewards."""
        return {"lowest": -1.0, "highest": 2.0}

    def _first_state(self) -> Arrays:
        # one draw with probability 1 / O changes the logarithm by gamma * (reward * O) / O
        first = self.prior * self.gamma * self._scaled(self.problem.scores)
        return {"log_weights": np.tile(first - first.max(), (self.groups, 1))}

    def chances(self, decisions: Decisions) -> Floats:
        """Return the probability (K, O) of each option: (1 - gamma) * its share of the weights + gamma / O."""
        logarithms = np.where(decisions.allowed, self.log_weights[decisions.groups], -np.inf)
        return (1.0 - self.gamma) * shares(logarithms) + self.gamma * even(decisions.allowed)

    def _select(self, decisions: Decisions) -> Ints:
        chances = self.chances(decisions)
        option = drawn(chances, decisions.draws[:, 0])
        self.chance[decisions.rows] = chance_of(chances, option)
        return option

    def _opinions(self, decisions: Decisions) -> Floats:
        return self.chances(decisions)

    def _update(self, outcomes: Outcomes) -> None:
        estimated = self._scaled(outcomes.reward) / outcomes.chance
        steps = self.gamma * estimated / self.options
        np.add.at(self.log_weights, (outcomes.groups, outcomes.option), steps)
        self.log_weights -= self.log_weights.max(axis=1, keepdims=True)

    def _scaled(self, reward: Floats) -> Floats:
        return np.clip((reward - self.lowest) / (self.highest - self.lowest), 0.0, 1.0)
