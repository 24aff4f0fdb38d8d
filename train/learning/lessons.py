"""Lessons for a bandit: what it decided, and what this brought, by the rewards that follow or by the costs of missions.

After each decision: rows decide when their situation changes, or after some time. A decision is credited with the
discounted rewards within a horizon.

By missions: each team chooses an option for every situation once in a mission. The effect of an option often appears
only when the whole team uses it for minutes: robots that keep their distance meet less often later. The costs of
missions depend far more on the scenarios than on the decisions. Therefore several teams get the same scenario, and the
reward of a decision is the difference of its mission's cost to the others of the group. This is the baseline of
REINFORCE with several rollouts (Kool et al. 2019, "Buy 4 REINFORCE samples, get a baseline for free"), here with the
median, because a few failed missions would change a mean.

Shapes: R rows; M missions of a round, G of each scenario; S situations, at least one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice
from typing import NamedTuple

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.learning.joined import Joined
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Flags, Floats, Ints
from selforg.elementary import logarithms
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import TeamsDecider, columns_of
from train.deciders.machines import RuleDecider
from train.learning.config import ComparisonConfig, TrainingConfig
from train.learning.curriculum import Curriculum
from train.learning.training import judged
from train.running.trials import TrialSettings, run_trials


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


class MissionLearning:
    """Learning in which teams decide once in a mission and are rewarded for its cost; see `ComparisonConfig`.

    Attributes:
        teams: (R,) mission of each row; rows are the situations of all missions of a round, R = M * S.

    """

    def __init__(self, config: TrainingConfig, curriculum: Curriculum, trials: TrialSettings) -> None:
        assert config.bandit is not None
        self._config, self._curriculum, self._trials = config, curriculum, trials
        self._situations, self._compared = config.bandit.context, config.bandit.comparison or ComparisonConfig()
        self._contexts: Floats = np.eye(len(self._situations)) if self._situations else np.zeros((1, 0))
        self._missions = sum(task.worlds for task in config.tasks)
        self.teams: Ints = np.repeat(np.arange(self._missions), len(self._contexts))

    def lessons(self, strategy: DecisionStrategy, checkpoint: int) -> Lessons:
        """Let the strategy decide until the next checkpoint; yield what it can learn after each round of missions."""
        contexts = np.tile(self._contexts, (self._missions, 1))
        rows = np.arange(len(self.teams))
        following = self._curriculum.scenarios(checkpoint)
        for _ in range(-(-self._config.decisions // len(rows))):
            scenarios = [
                scenario
                for task, series in zip(self._config.tasks, following, strict=True)
                for scenario in islice(series, task.worlds // self._compared.group)
            ]
            options = strategy.select(contexts)
            chances = strategy.chance.copy()
            cost = self._costs(scenarios, options.reshape(self._missions, -1))
            rewards = np.repeat(relative(cost, self._compared.group, self._compared.limit), len(self._contexts))
            yield Paid(rows, options, rewards, contexts, chances), len(rows), cost.tolist()

    def _costs(self, scenarios: Sequence[Scenario], rules: Ints) -> Floats:
        """Return the excess (M,) [s] of missions in which teams follow `rules` (M, S); G missions for each scenario."""
        missions = [scenario for scenario in scenarios for _ in range(self._compared.group)]
        makers = [partial(RuleDecider, self._situations, rule) for rule in rules]
        maker = partial(TeamsDecider, makers, [scenario.seed for scenario in missions])
        return np.array([judged(result) for result in run_trials(missions, maker, self._trials)])


def relative(cost: Floats, group: int, limit: float) -> Floats:
    """Return the rewards (M,) of missions, compared with their groups: -ln(cost / median), limited to +-`limit` [-].

    >>> relative(np.array([10.0, 40.0, 20.0, 5.0, 5.5, 5.0]), 3, limit=0.5).round(2).tolist()
    [0.5, -0.5, 0.0, 0.0, -0.1, 0.0]

    """
    grouped = logarithms(cost).reshape(-1, group)
    rewards: Floats = (np.median(grouped, axis=1, keepdims=True) - grouped).ravel()
    return np.clip(rewards, -limit, limit) + 0.0
