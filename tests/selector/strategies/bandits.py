"""Synthetic bandits on which strategies prove that they learn: many independent rows at once."""

from collections.abc import Callable

import numpy as np

from selector.strategies.problem import Problem
from selector.strategies.registry import create
from selector.strategies.streams import row_keys

Means = Callable[[int, np.ndarray], np.ndarray]
"""Mean rewards (R, O) or (1, O), given the step and the contexts (R, F)."""


def regrets(name, parameters, means, *, steps, rows=60, noise=0.25, seed=0, features=0, scores=None):
    """Return the mean regret (steps,) of rows that learn each for itself.

    Args:
        name: of the strategy.
        parameters: of the strategy.
        means: function of the step and the contexts (R, F) that gives the mean reward (R, O) of each option.
        steps: number of decisions of each row.
        rows: number of rows, R.
        noise: standard deviation of a reward.
        seed: of everything random.
        features: number of features of a context, F; standard normal.
        scores: (O,) of the expert; all 0 unless given.

    """
    generator = np.random.default_rng(seed)
    options = means(0, np.zeros((1, features))).shape[1]
    scores = np.zeros(options) if scores is None else scores
    problem = Problem("Goal", tuple(f"o{k}" for k in range(options)), scores, names(features))
    strategy = create(name, problem, row_keys(np.random.SeedSequence(seed), rows), parameters, groups=np.arange(rows))
    lost = np.empty(steps)
    for step in range(steps):
        context = generator.normal(size=(rows, features))
        expected = np.broadcast_to(means(step, context), (rows, options))
        option = strategy.select(context)
        gained = expected[np.arange(rows), option]
        strategy.update(option, gained + noise * generator.normal(size=rows), context)
        lost[step] = (expected.max(axis=1) - gained).mean()
    return lost


def names(features):
    return tuple(f"x{k}" for k in range(features))


def constant(*means):
    return lambda step, context: np.array([means])


def linear(*slopes):
    """Return means that are the products of the context with one vector for each option."""
    return lambda step, context: context @ np.array(slopes).T
