"""Upper confidence bounds over the rewards of the last steps, for rewards that jump."""

from typing import Annotated

import numpy as np
from pydantic import Field

from selector.documents.arrays import Arrays
from selector.strategies.bandits.optimism import RecentParameters, RecentUCB
from selector.strategies.problem import Outcomes
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import LEARNED_LIMIT
from selforg.arrays import Floats, Ints


class SlidingWindowUCBParameters(RecentParameters):
    """How wide the bounds are, and how many steps count."""

    window: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 200
    """Number of steps whose rewards count, tau of the paper [steps]."""


@STRATEGIES.register
class SlidingWindowUCB(RecentUCB):
    """Sliding-window UCB (Garivier & Moulines 2011, doi:10.1007/978-3-642-24412-4_16, algorithm 2).

    A step is one update with rewards of any number of robots of a group, so that the window does not depend on the size
    of the team. The scores of the expert do not leave the window.
    """

    Parameters = SlidingWindowUCBParameters
    parameters: SlidingWindowUCBParameters
    width = 1.0
    step_counts: Floats  # (G, T, O) number of rewards in each of the last T steps
    step_totals: Floats  # (G, T, O) sum of these rewards
    cursor: Ints  # (G,) index of the next step

    def _first_state(self) -> Arrays:
        shape = (self.groups, self.parameters.window, self.options)
        return {
            "step_counts": np.zeros(shape),
            "step_totals": np.zeros(shape),
            "counts": np.zeros((self.groups, self.options)),
            "totals": np.zeros((self.groups, self.options)),
            "cursor": np.zeros(self.groups, dtype=np.int64),
        }

    def _ranges(self) -> dict[str, tuple[float, float]]:
        some = (0.0, LEARNED_LIMIT)
        return {"counts": some, "step_counts": some, "cursor": (0, self.parameters.window - 1)}

    def _update(self, outcomes: Outcomes) -> None:
        touched = np.unique(outcomes.groups)
        now = self.cursor[touched]
        place = (outcomes.groups, self.cursor[outcomes.groups], outcomes.option)
        for steps, sums, added in (
            (self.step_counts, self.counts, np.ones(len(outcomes.option))),
            (self.step_totals, self.totals, outcomes.reward),
        ):
            sums[touched] -= steps[touched, now]  # the oldest step leaves the window
            steps[touched, now] = 0.0
            np.add.at(steps, place, added)
            sums[touched] += steps[touched, now]
        self.cursor[touched] = (now + 1) % self.parameters.window
        # After T steps the sums are computed again, so that errors of rounding do not grow.
        round_begins = touched[self.cursor[touched] == 0]
        self.totals[round_begins] = self.step_totals[round_begins].sum(axis=1)
