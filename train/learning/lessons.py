"""Lessons for a bandit: what it decided, and which rewards followed.

Rows decide when their situation changes, or after some time. A decision is credited with the discounted rewards within
a horizon.

Shapes: R rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from clean_swarm_env.learning.joined import Joined
from selector.store import RewardSums
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Flags, Floats, Ints
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import columns_of
from train.learning.config import CreditConfig, TrainingConfig
from train.learning.curriculum import Curriculum


class Paid(NamedTuple):
    """K decisions whose rewards are complete."""

    rows: Ints
    options: Ints
    rewards: Floats
    contexts: Floats
    chances: Floats


Lessons = Iterator[tuple[Paid, int, list[float]]]
"""Decisions with complete rewards, the number of decisions made since the last lesson, and the excess costs [s] of the
missions that ended since."""


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
        self._period = curriculum.batches[0].mission.decision_period
        self._columns = columns_of(goal.problem, config.bandit.context, "context")
        self._watched = columns_of(goal.problem, self._credit.until, "until")
        self.teams: Ints = self._joined.world_of

    def lessons(self, strategy: DecisionStrategy, checkpoint: int) -> Lessons:
        """Let the strategy decide until the next checkpoint; yield what it can learn after each period."""
        self._curriculum.set_scenarios(checkpoint)
        seen, rows = self._joined.reset(), self._joined.rows
        periods = max(round(self._credit.horizon / self._period), 1)
        credit = Credit(rows, periods, len(self._columns), self._credit.discount**self._period)
        hold = round(self._credit.hold / self._period) or np.iinfo(np.int64).max
        left, options = np.zeros(rows, dtype=np.int64), np.zeros(rows, dtype=np.int64)
        watched = seen[:, self._watched].copy()
        for _ in range(-(-self._decisions // rows)):
            changed = (seen[:, self._watched] != watched).any(axis=1)
            watched = seen[:, self._watched].copy()
            deciding = np.flatnonzero(((left <= 0) | changed) & self._joined.working)
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
            yield credit.pay(step.rewards, over), rows, [end.result.excess_s for end in self._joined.finished]


class Credit:
    """Decisions that wait for their rewards.

    A decision gets the discounted rewards of the H periods that follow, or of fewer if the mission ends before. R rows,
    F components of a context.
    """

    def __init__(self, rows: int, periods: int, features: int, discount: float) -> None:
        """`periods` is H, `discount` the weight of a reward one period later."""
        self._discount = discount
        self._place = 0
        self._waits = np.zeros((periods, rows), dtype=np.bool_)
        self._options = np.zeros((periods, rows), dtype=np.int64)
        self._sums = np.zeros((periods, rows))
        self._weights = np.ones((periods, rows))
        self._chances = np.ones((periods, rows))
        self._contexts = np.zeros((periods, rows, features))

    def decide(self, rows: Ints, options: Ints, contexts: Floats, chances: Floats) -> None:
        """Note the `options` (K,) that `rows` (K,) chose for the period that begins."""
        place = self._place
        self._waits[place, rows] = True
        self._options[place, rows], self._chances[place, rows] = options, chances
        self._contexts[place, rows] = contexts
        self._sums[place, rows], self._weights[place, rows] = 0.0, 1.0

    def pay(self, rewards: Floats, over: Flags) -> Paid:
        """Add the `rewards` (R,) of a period, after which missions may be `over` (R,); return complete decisions."""
        self._sums += self._weights * rewards
        self._weights *= self._discount
        self._place = (self._place + 1) % len(self._waits)
        complete = self._waits & over
        complete[self._place] |= self._waits[self._place]  # its place is needed next
        places, rows = np.nonzero(complete)
        self._waits[places, rows] = False
        return Paid(
            rows=rows,
            options=self._options[places, rows],
            rewards=self._sums[places, rows],
            contexts=self._contexts[places, rows],
            chances=self._chances[places, rows],
        )


class Ledger:
    """What the options of several goals brought, for a knowledge store: each choice is credited as a bandit's is.

    Args:
        options: goal -> names of its options.
        rows: R.
        period: time between two decisions [s].

    """

    def __init__(self, options: Mapping[str, Sequence[str]], rows: int, period: float) -> None:
        self._options, credit = options, CreditConfig()
        periods = max(round(credit.horizon / period), 1)
        self._credits = [Credit(rows, periods, 0, credit.discount**period) for _ in options]
        self._sums = [RewardSums(goal, names) for goal, names in options.items()]

    def note(self, options: Ints, chosen: Flags, rewards: Floats, over: Flags) -> None:
        """Note a period: `options` (R, G), which of them were `chosen` (R, G) anew, and what came of it (R,)."""
        for column, (credit, sums) in enumerate(zip(self._credits, self._sums, strict=True)):
            rows = np.flatnonzero(chosen[:, column])
            credit.decide(rows, options[rows, column], np.zeros((len(rows), 0)), np.ones(len(rows)))
            paid = credit.pay(rewards, over)
            sums.record(paid.options, paid.rewards)

    def taken(self) -> list[RewardSums]:
        """Return the sums since the last call, of goals that have some."""
        found = [sums for sums in self._sums if sums.count]
        self._sums = [RewardSums(goal, names) for goal, names in self._options.items()]
        return found
