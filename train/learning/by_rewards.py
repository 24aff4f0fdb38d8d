"""Learning from the rewards after each decision: rows decide when their situation changes, or after some time."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.joined import Joined
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Ints
from train.learning.config import TrainingConfig
from train.learning.credit import Credit
from train.learning.curriculum import Curriculum
from train.learning.protocol import Taker
from train.running.decided_goal import DecidedGoal
from train.running.pilots import columns_of


class RewardLearning:
    """Learning in which all robots of all worlds decide; see `CreditConfig` for the times and the rewards.

    Attributes:
        teams: (R,) world of each row; rows are robots.

    """

    def __init__(self, config: TrainingConfig, curriculum: Curriculum, goal: DecidedGoal) -> None:
        assert config.bandit is not None
        self._goal = goal
        self._decisions, self._credit, self._curriculum = config.decisions, config.bandit.credit, curriculum
        self._joined = Joined(curriculum.batches)
        self._period = self._joined.batches[0].mission.decision_period
        self._columns = columns_of(goal.problem, config.bandit.context, "context")
        self._watched = columns_of(goal.problem, self._credit.until, "until")
        self.teams: Ints = self._joined.world_of

    def learn(self, strategy: DecisionStrategy, checkpoint: int, take: Taker) -> list[float]:
        """Train the strategy until the next checkpoint; return the costs of the missions that ended [s]."""
        self._curriculum.begin(checkpoint)
        seen, rows = self._joined.reset(), self._joined.rows
        periods = max(round(self._credit.horizon / self._period), 1)
        credit = Credit(rows, periods, len(self._columns), self._credit.discount**self._period)
        hold = round(self._credit.hold / self._period) or np.iinfo(np.int64).max
        left, options = np.zeros(rows, dtype=np.int64), np.zeros(rows, dtype=np.int64)
        watched, costs = seen[:, self._watched].copy(), []
        for _ in range(-(-self._decisions // rows)):
            changed = (seen[:, self._watched] != watched).any(axis=1)
            watched = seen[:, self._watched].copy()
            deciding = np.flatnonzero(((left <= 0) | changed) & self._joined.present)
            if len(deciding):
                context = seen[deciding][:, self._columns].astype(np.float64)
                options[deciding] = strategy.select(context, rows=deciding)
                credit.decide(deciding, options[deciding], context, strategy.chance[deciding])
                left[deciding] = hold
            step = self._joined.step(self._goal.actions(options))
            over = (step.terminated | step.truncated)[self.teams]
            left -= 1
            left[over] = 0
            seen = step.observations
            take(credit.pay(step.rewards, over), rows)
            costs += [end.result.cost_s for end in self._joined.finished]
        return costs
