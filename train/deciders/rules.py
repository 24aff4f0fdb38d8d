"""Rules: an option for each situation of a robot.

Shapes: R rows, S situations, at least one; M missions.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Sequence

import numpy as np

from clean_swarm_env.learning.observation.observer import Observations
from selector.strategies.problem import Problem
from selforg.arrays import Ints
from train.deciders.decider import OptionDecider, columns_of


class RuleDecider(OptionDecider):
    """Each row decides by its own rule.

    Args:
        problem: see `Decider`.
        situations: components of the observation; the largest one gives the situation of a robot. Empty: S is 1.
        rules: (R, S) options.

    """

    def __init__(self, problem: Problem, situations: tuple[str, ...], rules: Ints) -> None:
        super().__init__(problem)
        self._columns, self.rules = columns_of(problem, situations, "context"), rules

    def _choose(self, observations: Observations) -> Ints:
        rows = np.arange(len(self.rules))
        situations = observations[:, self._columns].argmax(axis=1) if len(self._columns) else np.zeros_like(rows)
        chosen: Ints = self.rules[rows, situations]
        return chosen


class TeamRuleDecider(RuleDecider):
    """Each team follows one rule during its mission.

    Args:
        problem: see `Decider`.
        situations: see `RuleDecider`.
        rows: R.
        seeds: (M,) seed of each mission; missions of one seed begin in this order.
        rules: (M, S) options of each mission.

    """

    def __init__(
        self, problem: Problem, situations: tuple[str, ...], rows: int, seeds: Sequence[int], rules: Ints
    ) -> None:
        super().__init__(problem, situations, np.zeros((rows, rules.shape[1]), dtype=np.int64))
        self._waiting: dict[int, deque[Ints]] = defaultdict(deque)
        for seed, rule in zip(seeds, rules, strict=True):
            self._waiting[seed].append(rule)

    def reset(self, rows: Ints, seed: int) -> None:
        """Give `rows` (N,) the rule of the next mission of a seed."""
        self.rules[rows] = self._waiting[seed].popleft()
