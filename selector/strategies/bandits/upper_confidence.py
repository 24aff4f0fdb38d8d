"""Upper confidence bounds: UCB1 for rewards that stay the same, and two strategies for rewards that change."""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from selector.documents.arrays import Arrays
from selector.documents.fields import NonNegative, Number
from selector.strategies.bandits.value_table import Pseudocount, ValueTable, summed, weighted
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions, Outcomes
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import LEARNED_LIMIT, DecisionStrategy
from selforg.arrays import Floats, Ints
from selforg.elementary import logarithms


class RecentUCB(DecisionStrategy):
    """Upper confidence bounds over recent rewards, by Garivier & Moulines; subclasses keep `counts` and `totals`."""

    prior: Pseudocount = 1.0
    """The expert's score of an option counts as this many rewards of that size [rewards]."""
    exploration: NonNegative = 1.0
    """Range of the rewards, B of the paper [reward]."""
    confidence: NonNegative = 0.5
    """The paper's xi [-]; theory asks for more than 0.5."""
    width: ClassVar[float]
    """Factor of the bounds in the paper."""
    counts: Floats  # (G, O) weight of the rewards that count
    totals: Floats  # (G, O) weighted sum of these rewards

    def estimates(self) -> Floats:
        """Return the present estimate (G, O) of the reward of each option."""
        means = self.totals / np.where(self.counts > 0.0, self.counts, 1.0)
        return weighted(self.counts, means, self.prior, self.problem.scores)

    def _select(self, decisions: Decisions) -> Ints:
        width = self.width * self.exploration * np.sqrt(self.confidence)
        return most_promising(decisions, self.estimates(), self.counts + self.prior, width, self.problem.scores)

    def _opinions(self, decisions: Decisions) -> Floats:
        return self.estimates()[decisions.groups]


def most_promising(decisions: Decisions, means: Floats, pulls: Floats, width: float, scores: Floats) -> Ints:
    """Return the option (K,) of the highest upper bound mean + width * sqrt(ln(sum of pulls) / pulls).

    Options never tried come first, by the expert's `scores` (O,), as the algorithms begin by trying each once.

    Args:
        decisions: K decisions.
        means: (G, O) estimated rewards.
        pulls: (G, O) number of trials, 0 or more, not necessarily whole.
        width: factor of the confidence interval.
        scores: (O,) the scores of the expert.

    """
    tried = pulls > 0.0
    total = pulls.sum(axis=1, keepdims=True)
    certainty = logarithms(np.maximum(total, 1.0)) / np.where(tried, pulls, 1.0)
    bounds = means + width * np.sqrt(certainty)
    untried = decisions.allowed & ~tried[decisions.groups]
    favourite = best(np.broadcast_to(scores, untried.shape), untried)
    return np.where(untried.any(axis=1), favourite, best(bounds[decisions.groups], decisions.allowed))


@STRATEGIES.register
class UCB1(ValueTable):
    """UCB1 (Auer, Cesa-Bianchi & Fischer 2002, doi:10.1023/A:1013689704352, figure 1).

    The bound of option i is mean_i + exploration * sqrt(2 ln n / n_i), n being the sum of all n_i. The expert prefers
    the worse of two options here; with `prior` 0 each is tried once, and then the better one is taken:

    >>> import numpy as np
    >>> from selector.strategies.problem import Problem
    >>> from selector.strategies.registry import create
    >>> problem = Problem("AvoidCollision", ("ORCA", "Off"), np.array([0.5, 1.0]))
    >>> strategy = create("UCB1", problem, np.arange(1, dtype=np.uint64), {"exploration": 0.2, "prior": 0.0})
    >>> taken = []
    >>> for _ in range(50):
    ...     option = strategy.select(np.zeros((1, 0)))
    ...     strategy.update(option, np.where(option == 0, 0.8, 0.3), np.zeros((1, 0)))
    ...     taken.append(problem.options[option[0]])
    >>> taken[:4], taken.count("ORCA")
    (['Off', 'ORCA', 'ORCA', 'ORCA'], 49)

    """

    exploration: NonNegative = 1.0
    """Factor of the confidence interval [reward]; the range of the rewards gives the interval of the paper."""

    def _select(self, decisions: Decisions) -> Ints:
        pulls, width = self.counts + self.prior, self.exploration * np.sqrt(2.0)
        return most_promising(decisions, self.estimates(), pulls, width, self.problem.scores)


@STRATEGIES.register
class DiscountedUCB(RecentUCB):
    """Discounted UCB (Garivier & Moulines 2011, doi:10.1007/978-3-642-24412-4_16, algorithm 1).

    A step is one update with rewards of any number of robots of a group, so that the discount does not depend on the
    size of the team. The scores of the expert are not discounted.
    """

    discount: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.99
    """Factor by which all earlier rewards lose weight at each step [-]."""
    width = 2.0

    def _first_state(self) -> Arrays:
        shape = (self.groups, self.options)
        return {"counts": np.zeros(shape), "totals": np.zeros(shape)}

    def _ranges(self) -> dict[str, tuple[float, float]]:
        return {"counts": (0.0, LEARNED_LIMIT)}

    def _update(self, outcomes: Outcomes) -> None:
        place = (outcomes.groups, outcomes.option)
        touched = np.unique(outcomes.groups)
        self.counts[touched] *= self.discount
        self.totals[touched] *= self.discount
        self.counts += summed(place, np.ones(len(outcomes.option)), self.counts.shape)
        self.totals += summed(place, outcomes.reward, self.totals.shape)


@STRATEGIES.register
class SlidingWindowUCB(RecentUCB):
    """Sliding-window UCB (Garivier & Moulines 2011, doi:10.1007/978-3-642-24412-4_16, algorithm 2).

    A step is one update with rewards of any number of robots of a group, so that the window does not depend on the size
    of the team. The scores of the expert do not leave the window.
    """

    window: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 200
    """Number of steps whose rewards count, tau of the paper [steps]."""
    width = 1.0
    step_counts: Floats  # (G, T, O) number of rewards in each of the last T steps
    step_totals: Floats  # (G, T, O) sum of these rewards
    cursor: Ints  # (G,) index of the next step

    def _first_state(self) -> Arrays:
        shape = (self.groups, self.window, self.options)
        return {
            "step_counts": np.zeros(shape),
            "step_totals": np.zeros(shape),
            "counts": np.zeros((self.groups, self.options)),
            "totals": np.zeros((self.groups, self.options)),
            "cursor": np.zeros(self.groups, dtype=np.int64),
        }

    def _ranges(self) -> dict[str, tuple[float, float]]:
        some = (0.0, LEARNED_LIMIT)
        return {"counts": some, "step_counts": some, "cursor": (0, self.window - 1)}

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
        self.cursor[touched] = (now + 1) % self.window
        # After T steps the sums are computed again, so that errors of rounding do not grow.
        round_begins = touched[self.cursor[touched] == 0]
        self.totals[round_begins] = self.step_totals[round_begins].sum(axis=1)
