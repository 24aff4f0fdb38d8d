"""Rules: an option for each situation that a robot can be in.

Shapes: R rows, S situations.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.observation.observer import Observations
from selector.strategies.problem import Problem
from train.learning.protocol import columns_of

Ints = NDArray[np.int64]


class RulePilot:
    """Each row decides by a rule of its own.

    Args:
        problem: goal and options; its features are all components of the observation.
        situations: components of it, the largest of which says in which situation a robot is; none: S is 1.
        rules: (R, S) options.

    """

    def __init__(self, problem: Problem, situations: tuple[str, ...], rules: Ints) -> None:
        self._columns = columns_of(problem, situations, "context")
        self.rules = rules

    def begin(self, rows: Ints, seed: int) -> None:
        """Nothing changes with a mission."""

    def choose(self, observations: Observations) -> Ints:
        """Return the option (R,) of the situation that each row is in."""
        rows = np.arange(len(self.rules))
        situations = observations[:, self._columns].argmax(axis=1) if len(self._columns) else np.zeros_like(rows)
        chosen: Ints = self.rules[rows, situations]
        return chosen
