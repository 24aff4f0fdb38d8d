"""Rewards as linear functions of the context, one for each option: the regression, and LinUCB."""

from __future__ import annotations

import numpy as np

from selector.documents.arrays import Arrays
from selector.documents.fields import NonNegative, Positive
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions, Outcomes
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import kernel


class LinearModel(DecisionStrategy):
    """Ridge regression of the reward on the context and a constant, for each group and option.

    With x = (1, context) and A = prior * I + sum of x x', kept as its inverse (Sherman & Morrison 1950,
    doi:10.1214/aoms/1177729893): weights = A^-1 (prior * (score, 0, ..., 0) + sum of reward * x).
    """

    prior: Positive = 1.0
    """Ridge: pseudo-count of the expert's score as constant term, and of 0 as weight of every feature [rewards]."""
    exploration: NonNegative = 1.0
    """Factor of the standard error of an estimate; 0: the estimate alone decides [reward]."""
    inverse: Floats  # (G, O, 1 + F, 1 + F) of A
    weights: Floats  # (G, O, 1 + F) of the constant and of each feature

    def _first_state(self) -> Arrays:
        width = 1 + self.features
        inverse = np.tile(np.eye(width) / self.prior, (self.groups, self.options, 1, 1))
        weights = np.zeros((self.groups, self.options, width))
        weights[:, :, 0] = self.problem.scores
        return {"inverse": inverse, "weights": weights}

    def predictions(self, decisions: Decisions) -> tuple[Floats, Floats]:
        """Return the expected reward (K, O) of each option and its standard error (K, O), in units of the noise."""
        expected, error = np.empty(decisions.allowed.shape), np.empty(decisions.allowed.shape)
        predict(self.inverse, self.weights, decisions.groups, _with_constant(decisions.context), expected, error)
        return expected, error

    def _opinions(self, decisions: Decisions) -> Floats:
        return self.predictions(decisions)[0]

    def _update(self, outcomes: Outcomes) -> None:
        inputs = _with_constant(outcomes.context)
        learn(self.inverse, self.weights, outcomes.groups, outcomes.option, inputs, outcomes.reward)


def _with_constant(context: Floats) -> Floats:
    return np.concatenate([np.ones((len(context), 1)), context], axis=1)


@kernel
def predict(inverse: Floats, weights: Floats, groups: Ints, inputs: Floats, expected: Floats, error: Floats) -> None:
    """Fill `expected` and `error` (K, O): weights' x and sqrt(x' A^-1 x) for `inputs` x (K, 1 + F)."""
    count, width = inputs.shape
    for k in range(count):
        group = groups[k]
        for option in range(weights.shape[1]):
            mean, variance = 0.0, 0.0
            for i in range(width):
                mean += weights[group, option, i] * inputs[k, i]
                product = 0.0
                for j in range(width):
                    product += inverse[group, option, i, j] * inputs[k, j]
                variance += inputs[k, i] * product
            expected[k, option] = mean
            error[k, option] = np.sqrt(max(variance, 0.0))


@kernel
def learn(inverse: Floats, weights: Floats, groups: Ints, option: Ints, inputs: Floats, reward: Floats) -> None:
    """Add K rewards to the regressions, one after the other, each by a rank-one update of an inverse."""
    count, width = inputs.shape
    product = np.empty(width)
    for k in range(count):
        group, chosen = groups[k], option[k]
        scale, expected = 1.0, 0.0
        for i in range(width):
            product[i] = 0.0
            for j in range(width):
                product[i] += inverse[group, chosen, i, j] * inputs[k, j]
            scale += inputs[k, i] * product[i]
            expected += weights[group, chosen, i] * inputs[k, i]
        surprise = (reward[k] - expected) / scale
        for i in range(width):
            weights[group, chosen, i] += product[i] * surprise
            for j in range(width):
                inverse[group, chosen, i, j] -= product[i] * product[j] / scale


@STRATEGIES.register
class LinUCB(LinearModel):
    """LinUCB with disjoint models (Li, Chu, Langford & Schapire 2010, doi:10.1145/1772690.1772758, algorithm 1).

    The bound is expected reward + exploration * standard error; `exploration` is the paper's alpha. Here never
    avoiding is better among few robots, and ORCA among many:

    >>> import numpy as np
    >>> from selector.strategies.problem import Problem
    >>> from selector.strategies.registry import create
    >>> problem = Problem("AvoidCollision", ("ORCA", "Off"), np.array([0.5, 0.5]), features=("crowd",))
    >>> strategy = create("LinUCB", problem, np.arange(1, dtype=np.uint64), {"exploration": 1.0})
    >>> for step in range(200):
    ...     context = np.array([[step % 5 / 4]])
    ...     option = strategy.select(context)
    ...     strategy.update(option, np.where(option == 0, 0.5, 1.0 - context[:, 0]), context)
    >>> [problem.options[strategy.select(np.array([[crowd]]))[0]] for crowd in (0.0, 0.25, 0.75, 1.0)]
    ['Off', 'Off', 'ORCA', 'ORCA']

    """

    def _select(self, decisions: Decisions) -> Ints:
        expected, error = self.predictions(decisions)
        return best(expected + self.exploration * error, decisions.allowed)
