"""Upper confidence bounds over the last steps only, for rewards that jump."""

from typing import Annotated

import numpy as np
from pydantic import Field

from selector.documents.arrays import Arrays
from selector.documents.fields import NonNegative
from selector.strategies.bandits.optimism import most_promising
from selector.strategies.bandits.value_table import PriorParameters, weighted
from selector.strategies.problem import Decisions, Outcomes
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints


class SlidingWindowUCBParameters(PriorParameters):
    """How optimistic to be, and how far to look back."""

    window: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 200
    """Number of steps whose rewards count, tau of the paper [steps]."""
    exploration: NonNegative = 1.0
    """Range of the rewards, B of the paper [reward]."""
    confidence: NonNegative = 0.5
    """The paper's xi [-]; theory asks for more than 0.5."""


@STRATEGIES.register
class SlidingWindowUCB(DecisionStrategy):
    """Sliding-window UCB (Garivier & Moulines 2011, doi:10.1007/978-3-642-24412-4_16, algorithm 2).

    A step is one update in which a group has rewards, be they of one robot or of all, so that the window does not
    depend on the size of the team. The expert's scores do not leave the window.
    """

    Parameters = SlidingWindowUCBParameters
    parameters: SlidingWindowUCBParameters
    step_counts: Floats  # (G, T, O) rewards in each of the last T steps
    step_totals: Floats  # (G, T, O) their sums
    counts: Floats  # (G, O) rewards in all of them
    totals: Floats  # (G, O) their sums
    cursor: Ints  # (G,) where the next step goes

    def _first_state(self) -> Arrays:
        shape = (self.groups, self.parameters.window, self.options)
        return {
            "step_counts": np.zeros(shape),
            "step_totals": np.zeros(shape),
            "counts": np.zeros((self.groups, self.options)),
            "totals": np.zeros((self.groups, self.options)),
            "cursor": np.zeros(self.groups, dtype=np.int64),
        }

    def estimates(self) -> Floats:
        """Return what each option is worth now (G, O)."""
        means = self.totals / np.where(self.counts > 0.0, self.counts, 1.0)
        return weighted(self.counts, means, self.parameters.prior, self.problem.scores)

    def _select(self, decisions: Decisions) -> Ints:
        settings = self.parameters
        width = settings.exploration * np.sqrt(settings.confidence)
        return most_promising(decisions, self.estimates(), self.counts + settings.prior, width, self.problem.scores)

    def _update(self, outcomes: Outcomes) -> None:
        touched = np.unique(outcomes.groups)
        now = self.cursor[touched]
        place = (outcomes.groups, self.cursor[outcomes.groups], outcomes.option)
        for steps, sums, added in (
            (self.step_counts, self.counts, np.ones(len(outcomes.option))),
            (self.step_totals, self.totals, outcomes.reward),
        ):
            sums[touched] -= steps[touched, now]  # what leaves the window
            steps[touched, now] = 0.0
            np.add.at(steps, place, added)
            sums[touched] += steps[touched, now]
        self.cursor[touched] = (now + 1) % self.parameters.window
        # once a round the sums are made anew, so that what rounding leaves behind does not grow
        round_begins = touched[self.cursor[touched] == 0]
        self.totals[round_begins] = self.step_totals[round_begins].sum(axis=1)
