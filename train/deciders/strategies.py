"""Deciders by strategies, which choose by the scores, their estimates or a network."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.observer import Observations
from selector.strategies.problem import Problem
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import row_keys
from selforg.arrays import Floats, Ints
from train.deciders.decider import OptionDecider


class StrategyDecider(OptionDecider):
    """A strategy that decides in every decision period, and does not learn.

    Args:
        strategy: decides among all options of `problem`, or among those that it knows.
        columns: (K,) components of an observation that are its context.
        problem: see `Decider`.

    """

    def __init__(self, strategy: DecisionStrategy, columns: Ints, problem: Problem) -> None:
        super().__init__(problem)
        self.strategy, self._columns = strategy, columns
        self._places: Ints = np.array([problem.options.index(name) for name in strategy.problem.options])

    def reset(self, rows: Ints, seed: int) -> None:
        """Give rows new keys of random numbers."""
        self.strategy.reseed(rows, row_keys(np.random.SeedSequence([seed, 1]), len(rows)))

    def opinions(self) -> Floats:
        """Return the scores, estimates or probabilities (R, O) of the strategy; the least for what it does not know."""
        known = self.strategy.opinions(self._context)
        thought = np.repeat(known.min(axis=1, keepdims=True), len(self.problem.options), axis=1)
        thought[:, self._places] = known
        return thought

    def _choose(self, observations: Observations) -> Ints:
        self._context = observations[:, self._columns].astype(np.float64)
        options: Ints = self._places[self.strategy.select(self._context)]
        return options
