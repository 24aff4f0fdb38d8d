"""Statistics of the rewards of each option, and the strategy that needs nothing else: EpsilonGreedy."""

from typing import Annotated

import numpy as np
from pydantic import Field

from selector.documents.arrays import Arrays
from selector.documents.fields import NonNegative, Share
from selector.strategies.choosing import best, chance_of, drawn, even
from selector.strategies.problem import Decisions, Outcomes
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import LEARNED_LIMIT, DecisionStrategy
from selforg.arrays import Floats, Ints
from selforg.elementary import exponentials

Pseudocount = Annotated[NonNegative, Field(le=1e12)]


class ValueTable(DecisionStrategy):
    """Count, mean and spread of the rewards of each option, in each group."""

    prior: Pseudocount = 1.0
    """The expert's score of an option counts as this many rewards of that size [rewards]."""
    counts: Floats  # (G, O) rewards
    means: Floats  # (G, O) of the rewards
    spreads: Floats  # (G, O) sum of squared deviations from the mean

    def _first_state(self) -> Arrays:
        count, mean, variance = self.problem.rewards
        known = {"counts": count, "means": mean, "spreads": count * variance}
        return {name: np.tile(values, (self.groups, 1)) for name, values in known.items()}

    def _ranges(self) -> dict[str, tuple[float, float]]:
        return {"counts": (0.0, LEARNED_LIMIT), "spreads": (0.0, LEARNED_LIMIT)}

    def estimates(self) -> Floats:
        """Return the estimated reward (G, O) of each option: the mean of its rewards and of the expert's score."""
        return weighted(self.counts, self.means, self.prior, self.problem.scores)

    def _opinions(self, decisions: Decisions) -> Floats:
        return self.estimates()[decisions.groups]

    def _update(self, outcomes: Outcomes) -> None:
        place, shape = (outcomes.groups, outcomes.option), self.counts.shape
        count = summed(place, np.ones(len(outcomes.option)), shape)
        mean = summed(place, outcomes.reward, shape) / np.maximum(count, 1.0)
        spread = summed(place, (outcomes.reward - mean[place]) ** 2, shape)
        merge_rewards(self.counts, self.means, self.spreads, count, mean, spread)


def summed(place: tuple[Ints, Ints], values: Floats, shape: tuple[int, ...]) -> Floats:
    """Return the sums (G, O) of `values` (K,) by group (K,) and option (K,), which `place` holds."""
    sums = np.bincount(place[0] * shape[1] + place[1], values, shape[0] * shape[1])
    return sums.astype(np.float64).reshape(shape)


def merge_rewards(counts: Floats, means: Floats, spreads: Floats, count: Floats, mean: Floats, spread: Floats) -> None:
    """Merge two sets of statistics (G, O): count, mean and sum of squared deviations; the first set is changed.

    Chan, Golub & LeVeque (1983), doi:10.1080/00031305.1983.10483115.
    """
    total = counts + count
    share = np.divide(count, total, out=np.zeros_like(total), where=total > 0.0)
    step = mean - means
    spreads += np.where(count > 0.0, spread, 0.0) + step * step * counts * share
    means += step * share
    counts += count


def weighted(counts: Floats, means: Floats, prior: float, scores: Floats) -> Floats:
    """Return means (G, O) of the rewards and of `scores` (O,), which count as `prior` rewards."""
    total = counts + prior
    known = total > 0.0
    values = (counts * means + prior * scores) / np.where(known, total, 1.0)
    return np.where(known, values, scores)


@STRATEGIES.register
class EpsilonGreedy(ValueTable):
    """Epsilon-greedy (Auer, Cesa-Bianchi & Fischer 2002, doi:10.1023/A:1013689704352, section 2)."""

    epsilon: Share = 0.1
    """Probability of taking any option that can serve, each with equal probability [-]."""
    decay: NonNegative = 0.0
    """Rate at which this probability falls, as epsilon * exp(-decay * number of rewards) [1/reward]."""
    draws_per_decision = 2  # whether to explore, and what

    def _select(self, decisions: Decisions) -> Ints:
        rewards = self.counts.sum(axis=1)
        epsilon = (self.epsilon * exponentials(-self.decay * rewards))[decisions.groups]
        greedy = best(self.estimates()[decisions.groups], decisions.allowed)
        anything = even(decisions.allowed)
        option = np.where(decisions.draws[:, 0] < epsilon, drawn(anything, decisions.draws[:, 1]), greedy)
        self.chance[decisions.rows] = epsilon * chance_of(anything, option) + (1.0 - epsilon) * (option == greedy)
        return option
