"""Deciders by strategies, which choose by scores or estimates, and by trained networks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.arrays import check_known
from selector.documents.errors import DocumentError
from selector.strategies.choosing import shares
from selector.strategies.policy_file import Network, TrainedPolicy
from selector.strategies.problem import Problem
from selector.strategies.registry import StrategySpec
from selector.strategies.streams import row_keys
from selforg.arrays import Floats, Ints
from train.deciders.decider import Decided, Decider, OptionDecider, columns_of


class StrategyDecider(OptionDecider):
    """A strategy that decides in every decision period, and does not learn.

    Args:
        spec: the strategy.
        problem, teams: see `Decider`.
        options: names of the options that it knows; all unless given.
        features: components of the observation that are its context.

    Attributes:
        strategy: the strategy.

    """

    def __init__(
        self,
        spec: StrategySpec,
        problem: Problem,
        teams: Ints,
        options: tuple[str, ...] = (),
        features: tuple[str, ...] = (),
    ) -> None:
        super().__init__(problem, teams)
        self._columns = columns_of(problem, features, f"strategy {spec.name}")
        known = replace(problem.only(options) if options else problem, features=features)
        self.strategy = spec.build(known, row_keys(np.random.SeedSequence(0), len(teams)), teams)
        self._places: Ints = np.array([problem.options.index(name) for name in known.options])

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


LEAST = float(np.finfo(np.float32).min)
"""Output of options that a network was not trained for: they are taken only where no other can serve."""


class PolicyDecider(Decider):
    """A trained network: the likeliest option, a movement vector, or both."""

    def __init__(self, policy: TrainedPolicy, problem: Problem, teams: Ints) -> None:
        super().__init__(problem, teams)
        spec = policy.spec
        check_known("policy", "options", problem.options, spec.options)
        if spec.options and spec.goal != problem.goal:
            raise DocumentError(f"policy: goal: expected {problem.goal}, got {spec.goal}")
        self._columns = columns_of(problem, spec.observations, "policy: observations")
        self._places = [problem.options.index(name) for name in spec.options]
        self._network = Network(policy)

    def opinions(self) -> Floats:
        """Return the probabilities (R, O) of the network."""
        return shares(self._outputs)

    def _decide(self, observations: Observations) -> Decided:
        rows = len(observations)
        heads = self._network.heads(observations[:, self._columns].astype(np.float64))
        self._outputs = np.full((rows, len(self.problem.options)), LEAST)
        self._outputs[:, self._places] = heads.get("options", np.zeros((rows, 0)))
        return Decided(self._outputs.argmax(axis=1), heads.get("vector", np.zeros((rows, 2))))
