"""Evaluations in which each robot decides by the observation of another one of its team.

A strategy that is as good this way does not use what its robot knows: only the mix of its options counts.
Shapes: R rows, F components of an observation.
"""

from collections.abc import Sequence

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.learning.observation.observer import Observations
from selector.strategies.problem import Problem
from selector.strategies.streams import row_keys, uniforms
from selforg.arrays import Floats, Ints
from train.deciders.decider import Decided, Decider
from train.evaluation.family import FamilyEvaluation
from train.evaluation.trial_task import TrialTask
from train.request import Request


class ShuffledDecider(Decider):
    """Lets another decider decide, from observations that change places within each team at each decision.

    Rows without a robot, whose observation is zero, keep theirs.

    Args:
        decider: the other decider.
        teams: (R,) number of the team of each row.

    """

    def __init__(self, decider: Decider, teams: Ints) -> None:
        super().__init__(decider.problem, teams)
        self._decider = decider
        self._keys = row_keys(np.random.SeedSequence(0), len(teams))
        self._drawn = np.zeros(len(teams), dtype=np.uint64)

    def reset(self, rows: Ints, seed: int) -> None:
        """Give `rows` (N,) new keys of random numbers."""
        self._decider.reset(rows, seed)
        self._keys[rows], self._drawn[rows] = row_keys(np.random.SeedSequence([seed, 3]), len(rows)), 0

    def opinions(self) -> Floats:
        """Return the opinions (R, O) of the other decider."""
        return self._decider.opinions()

    def _decide(self, observations: Observations) -> Decided:
        drawn = uniforms(self._keys, self._drawn, 1)[:, 0]
        self._drawn += np.uint64(1)
        absent = ~observations.any(axis=1)
        shuffled = observations.copy()
        shuffled[np.lexsort((absent, self.teams))] = observations[np.lexsort((drawn, absent, self.teams))]
        return self._decider.decide(shuffled)


class ShuffledTask(TrialTask):
    """Scenarios on which a member decides by shuffled observations."""

    def decider(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider."""
        return ShuffledDecider(super().decider(problem, teams), teams)


class ShuffledEvaluation(FamilyEvaluation):
    """The evaluation of strategies on a family with shuffled observations."""

    beside_baselines = False

    def __init__(self, request: Request) -> None:
        super().__init__(request, shuffled=True)

    def task(self, scenarios: Sequence[Scenario], condition: str, member: str) -> TrialTask:
        """Return the task of a member on scenarios."""
        return ShuffledTask(**vars(super().task(scenarios, condition, member)))
