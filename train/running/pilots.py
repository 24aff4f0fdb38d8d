"""Pilots, which choose an option for each row of a batch: by a strategy, a trained policy or a rule.

Shapes: R rows, F components of an observation, K components that a strategy sees, S situations.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np

from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.arrays import check_known
from selector.documents.errors import DocumentError
from selector.strategies.choosing import shares
from selector.strategies.policy import Network
from selector.strategies.policy_file import TrainedPolicy
from selector.strategies.problem import Problem
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import row_keys
from selforg.arrays import Floats, Ints
from selforg.registry import unknown
from train.running.model_pilots import VectorPilot


class Pilot(Protocol):
    """Chooses an option for each row."""

    def begin(self, rows: Ints, seed: int) -> None:
        """Prepare `rows` (N,) for a new mission with `seed`."""

    def choose(self, observations: Observations) -> Ints:
        """Return the option (R,) of each row for the next decision period, from its observations (R, F)."""

    def opinions(self) -> Floats:
        """Return what each row thought of each option (R, O) when it last chose, for recordings."""


AnyPilot = Pilot | VectorPilot
"""Chooses options, or steers."""
PilotMaker = Callable[[Problem, Ints], AnyPilot]
"""Makes a pilot for rows of teams (R,), for a problem whose features are all components of the observation."""


class StrategyPilot:
    """A strategy that decides in every decision period, and does not learn.

    Args:
        strategy: decides among all options of `problem`, or among those that it knows.
        columns: (K,) components of an observation that are its context.
        problem: goal and options.

    """

    def __init__(self, strategy: DecisionStrategy, columns: Ints, problem: Problem) -> None:
        self.strategy, self._columns, self._options = strategy, columns, len(problem.options)
        self._places: Ints = np.array([problem.options.index(name) for name in strategy.problem.options])

    def begin(self, rows: Ints, seed: int) -> None:
        """Give rows new keys of random numbers."""
        self.strategy.reseed(rows, row_keys(np.random.SeedSequence([seed, 1]), len(rows)))

    def choose(self, observations: Observations) -> Ints:
        """Return the options (R,) that the strategy selects."""
        self._context = observations[:, self._columns].astype(np.float64)
        options: Ints = self._places[self.strategy.select(self._context)]
        return options

    def opinions(self) -> Floats:
        """Return the scores, estimates or probabilities (R, O) of the strategy; the least for what it does not know."""
        known = self.strategy.opinions(self._context)
        thought = np.repeat(known.min(axis=1, keepdims=True), self._options, axis=1)
        thought[:, self._places] = known
        return thought


class PolicyPilot:
    """A trained network that always takes the likeliest option.

    Attributes:
        corrects: whether it also gives a vector, by which the movement is corrected.
        vectors: (R, 2) what it gave last.

    """

    def __init__(self, policy: TrainedPolicy, problem: Problem) -> None:
        names = policy.spec.observations
        check_known("policy", "options", problem.options, policy.spec.options)
        self._columns = columns_of(problem, names, "policy: observations")
        self._network = Network(policy.ordered_for(replace(problem, features=names), "policy"))
        self.corrects, self.vectors = policy.spec.vector, np.zeros((0, 2))

    def begin(self, rows: Ints, seed: int) -> None:
        """Do nothing: the decisions do not depend on the mission."""

    def choose(self, observations: Observations) -> Ints:
        """Return the likeliest options (R,)."""
        heads = self.heads(observations)
        self._outputs = heads["options"]
        self.vectors = heads.get("vector", self.vectors)
        options: Ints = self._outputs.argmax(axis=1)
        return options

    def heads(self, observations: Observations) -> dict[str, Floats]:
        """Return the outputs (R, ...) of each head of the network."""
        return self._network.heads(observations[:, self._columns].astype(np.float64))

    def opinions(self) -> Floats:
        """Return the probabilities (R, O) of the network."""
        return shares(self._outputs)


def policy_pilot(policy: TrainedPolicy, problem: Problem) -> AnyPilot:
    """Return the pilot of a policy that chooses options, corrects beside, or only steers."""
    pilot = PolicyPilot(policy, problem)
    return pilot if policy.spec.options else VectorPilot(lambda observations: pilot.heads(observations)["vector"])


class RulePilot:
    """Each row decides by its own rule, which has an option for each situation of a robot.

    Args:
        problem: goal and options; its features are all components of the observation.
        situations: components of the observation; the largest one gives the situation of a robot. Empty: S is 1.
        rules: (R, S) options.

    """

    def __init__(self, problem: Problem, situations: tuple[str, ...], rules: Ints) -> None:
        self._columns = columns_of(problem, situations, "context")
        self.rules, self._options = rules, len(problem.options)

    def begin(self, rows: Ints, seed: int) -> None:
        """Do nothing: the decisions do not depend on the mission."""

    def choose(self, observations: Observations) -> Ints:
        """Return the option (R,) of each row for its present situation."""
        rows = np.arange(len(self.rules))
        situations = observations[:, self._columns].argmax(axis=1) if len(self._columns) else np.zeros_like(rows)
        chosen: Ints = self.rules[rows, situations]
        self._chosen = chosen
        return chosen

    def opinions(self) -> Floats:
        """Return 1 for the option of the rule, 0 for the others (R, O)."""
        return np.eye(self._options)[self._chosen]


def columns_of(problem: Problem, names: tuple[str, ...], what: str) -> Ints:
    """Return the indices of components of an observation; DocumentError for an unknown name."""
    for name in names:
        if name not in problem.features:
            raise DocumentError(f"{what}: {unknown('component', name, problem.features)}")
    return np.array([problem.features.index(name) for name in names], dtype=np.int64)
