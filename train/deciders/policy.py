"""The decider by a trained network."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.arrays import check_known
from selector.strategies.choosing import shares
from selector.strategies.policy import Network
from selector.strategies.policy_file import TrainedPolicy
from selector.strategies.problem import Problem
from selforg.arrays import Floats
from train.deciders.decider import Decided, Decider, columns_of


class PolicyDecider(Decider):
    """A trained network: the likeliest option, a movement vector, or both."""

    def __init__(self, policy: TrainedPolicy, problem: Problem) -> None:
        super().__init__(problem)
        names = policy.spec.observations
        check_known("policy", "options", problem.options, policy.spec.options)
        self._columns = columns_of(problem, names, "policy: observations")
        self._network = Network(policy.ordered_for(replace(problem, features=names), "policy"))

    def opinions(self) -> Floats:
        """Return the probabilities (R, O) of the network."""
        return shares(self._outputs)

    def _decide(self, observations: Observations) -> Decided:
        rows = len(observations)
        heads = self._network.heads(observations[:, self._columns].astype(np.float64))
        self._outputs = heads.get("options", np.zeros((rows, len(self.problem.options))))
        return Decided(self._outputs.argmax(axis=1), heads.get("vector", np.zeros((rows, 2))))
