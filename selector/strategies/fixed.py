"""Always the same option: what learned strategies have to beat."""

from typing import Any

import numpy as np

from selector.documents.errors import DocumentError
from selector.documents.fields import Closed, Name
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions, Outcomes, Problem
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Ints
from selforg.registry import unknown


class FixedParameters(Closed):
    """Which option."""

    option: Name
    """Name of the option to take wherever it can serve; elsewhere it is the one of the highest score."""


@STRATEGIES.register
class Fixed(DecisionStrategy):
    """One option, whatever happens."""

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

    def _select(self, decisions: Decisions) -> Ints:
        return best(np.broadcast_to(self._order, decisions.allowed.shape), decisions.allowed)

    def _update(self, outcomes: Outcomes) -> None:
        pass  # fixed
