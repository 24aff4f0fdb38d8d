"""A decider for teams of several models: the robots of each model follow a decider of their own."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from clean_swarm_env.deciders.decider import DeciderMaker, OptionDecider
from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.plain import must_fit
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints

FLAG = "model_"
"""What begins the names of the components that say of which model a robot is."""


class ByModelDecider(OptionDecider):
    """Each row does what the decider of its model says. All of them decide for all rows, so that each keeps its memory.

    Args:
        makers: model -> what makes its decider.
        problem, teams: see `Decider`; the observation has the term `model`.

    Raises:
        DocumentError: the models are not those of the mission.

    """

    def __init__(self, makers: Mapping[str, DeciderMaker], problem: Problem, teams: Ints) -> None:
        super().__init__(problem, teams)
        there = [name.removeprefix(FLAG) for name in problem.features if name.startswith(FLAG)]
        named = "; ".join(f"{model}=STRATEGY" for model in there)
        must_fit(set(there) == set(makers), "models", named, f"strategies for {', '.join(makers)}")
        self._columns = [problem.features.index(f"{FLAG}{model}") for model in makers]
        self._deciders = [make(problem, teams) for make in makers.values()]

    def reset(self, rows: Ints, seed: int) -> None:
        """Prepare `rows` (N,) of all deciders."""
        for decider in self._deciders:
            decider.reset(rows, seed)

    def opinions(self) -> Floats:
        """Return what the decider of each row's model thought of each option (R, O)."""
        return np.asarray(np.stack([decider.opinions() for decider in self._deciders])[self._of, self._rows])

    def _choose(self, observations: Observations) -> Ints:
        self._of, self._rows = observations[:, self._columns].argmax(axis=1), np.arange(len(observations))
        each = np.stack([decider.decide(observations).options for decider in self._deciders])
        return np.asarray(each[self._of, self._rows])
