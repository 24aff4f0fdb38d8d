"""Learning from the excess costs of whole missions: each team chooses an option for every situation once in a mission.

The effect of an option often appears only when the whole team uses it for minutes: robots that keep their distance meet
less often later. The costs of missions depend far more on the scenarios than on the decisions. Therefore several teams
get the same scenario, and the reward of a decision is the difference of its mission's cost to the others of the group.
This is the baseline of REINFORCE with several rollouts (Kool et al. 2019, "Buy 4 REINFORCE samples, get a baseline for
free"), here with the median, because a few failed missions would change a mean.

Shapes: M missions of a round, G of each scenario; S situations, at least one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import islice

import numpy as np

from clean_swarm_env.config.families import Scenario
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints
from selforg.elementary import logarithms
from train.deciders.decider import TeamsDecider
from train.deciders.rules import RuleDecider
from train.learning.by_rewards import Lessons, Paid
from train.learning.config import ComparisonConfig, TrainingConfig
from train.learning.curriculum import Curriculum
from train.learning.training import judged
from train.running.trials import TrialSettings, run_trials


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
