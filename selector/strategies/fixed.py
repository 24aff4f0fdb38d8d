"""Always the same option: a yardstick for strategies that learn."""

from typing import Any

import numpy as np

from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, Label
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions, Problem
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints
from selforg.registry import unknown


class FixedParameters(Closed):
    """The option."""

    option: Label
    """Name of the option to take wherever it can serve; elsewhere the option of the highest score is taken."""


@STRATEGIES.register
class Fixed(DecisionStrategy):
    """The same option in every decision."""

    Parameters = FixedParameters
    parameters: FixedParameters

    @classmethod
    def example(cls, problem: Problem) -> dict[str, Any]:
        """Return one of the options."""
        return {"option": problem.options[len(problem.options) // 2]}

    def _prepare(self) -> None:
        name, known = self.parameters.option, self.problem.options
        if name not in known:
            raise DocumentError(f"strategy Fixed: goal {self.problem.goal}: {unknown('option', name, known)}")
        self._order = self.problem.scores.copy()
        self._order[known.index(name)] = np.inf

    def _opinions(self, decisions: Decisions) -> Floats:
        return np.isposinf(self._order).astype(np.float64)

    def _select(self, decisions: Decisions) -> Ints:
        return best(np.broadcast_to(self._order, decisions.allowed.shape), decisions.allowed)
