"""Learning from the costs of whole missions: what each team holds, what is compared, what is found."""

from functools import partial

import numpy as np
import pytest

from selector.documents.errors import DocumentError
from selector.strategies.learned_file import description_of, load_strategy
from selector.strategies.problem import Problem
from selector.strategies.streams import row_keys
from tests.train.learning.trainings import job, written
from train.deciders.decider import TeamsDecider
from train.deciders.machines import RuleDecider
from train.learning import lessons as mission_learning
from train.learning.bandit import BanditTraining
from train.learning.config import load_training
from train.learning.lessons import MissionLearning, relative

SITUATIONS = ("free_far", "carrying_far")
OPTIONS = ("a", "b", "c")


def test_teams_keep_to_their_rules_in_the_order_in_which_missions_begin():
    problem = Problem("AvoidCollision", OPTIONS, np.zeros(3), ("other", *SITUATIONS))
    rules = [partial(RuleDecider, SITUATIONS, rule) for rule in ((0, 1), (1, 2), (2, 0))]
    decider = TeamsDecider(rules, [7, 9, 7], problem, np.repeat([0, 1], 2))
    first, second = np.array([0, 1]), np.array([2, 3])
    decider.reset(second, 7)
    decider.reset(first, 9)
    seen = np.array([[9.0, 1, 0], [9, 0, 1], [9, 1, 0], [9, 0, 1]], dtype=np.float32)
    assert decider.decide(seen).options.tolist() == [1, 2, 0, 1]
    decider.reset(second, 7)
    assert decider.decide(seen).options.tolist() == [1, 2, 2, 0]


def test_missions_are_compared_with_those_of_their_scenario_only():
    costs = np.array([10.0, 20.0, 40.0, 1.0, 2.0, 80.0])
    rewards = relative(costs, 3, limit=1.0)
    np.testing.assert_allclose(rewards, [np.log(2.0), 0.0, np.log(0.5), np.log(2.0), 0.0, -1.0])
    np.testing.assert_array_equal(relative(costs[3:], 3, limit=1.0), rewards[3:])


def test_the_best_option_of_each_situation_is_found_and_exported(tmp_path, monkeypatch):
    config = load_training(str(written(tmp_path, "missions", decisions=1600, checkpoints=1)), "bandit")
    best = np.array([2, 0])  # of each situation
    noise = np.random.default_rng(0)

    def costs(learning, scenarios, rules):
        hardness = np.repeat([1.0 + scenario.seed % 97 for scenario in scenarios], config.bandit.comparison.group)
        return hardness * np.exp(0.2 * (rules != best).sum(axis=1) + noise.normal(scale=0.1, size=len(rules)))

    monkeypatch.setattr(MissionLearning, "_costs", costs)
    monkeypatch.setattr("train.learning.training.results_on", lambda *_: {})
    monkeypatch.setattr("train.learning.training.figures_of", lambda _: {"random/excess_s": 1.0})
    monkeypatch.setattr("train.learning.training.excesses", lambda _: {"random": [1.0]})
    monkeypatch.setattr("train.learning.training.best_fixed", lambda *_: ("none", {"random": [1.0]}))
    training = BanditTraining(job(config, tmp_path / "run"))
    training.advance()
    assert training.decisions == 1600
    path = training.export("command")
    description = description_of(path)
    spec = description.spec
    assert (spec.parameters["exploration"], description.features) == (0.0, SITUATIONS)
    learned = spec.build(training.problem, row_keys(np.random.SeedSequence(0), 2), np.zeros(2, dtype=np.int64))
    load_strategy(path, learned)
    assert learned.select(np.eye(2)).tolist() == best.tolist()


def test_every_team_of_a_group_does_the_same_scenario(tmp_path, monkeypatch):
    config = load_training(str(written(tmp_path, "missions", checkpoints=1)), "bandit")
    did = []

    def trials(scenarios, maker, settings):
        did.append([scenario.seed for scenario in scenarios])
        return original(scenarios, maker, settings)

    original = mission_learning.run_trials
    monkeypatch.setattr(mission_learning, "run_trials", trials)
    training = BanditTraining(job(config, tmp_path / "run"))
    training.advance()
    (seeds,) = did
    assert seeds[0] == seeds[1] != seeds[2] == seeds[3]
    assert all(seed % 2 == 0 for seed in seeds)
    assert training.history.entries[0]["missions"] == 4


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"comparison": {"group": 3}}, "tasks: random: expected worlds that make groups of 3, got 4"),
        ({"comparison": {"group": 1}}, "group"),
        ({"exported": {"exploring": 0.0}}, "exploring"),
        ({"exported": {"exploration": -1.0}}, "exploration"),
    ],
)
def test_mistakes_are_told_when_the_file_is_read(tmp_path, changes, line):
    path = written(tmp_path, "missions")
    bandit = load_training(str(path), "bandit").bandit.model_dump(mode="json")
    with pytest.raises(DocumentError, match=line):
        load_training(str(written(tmp_path, "missions", bandit=bandit | changes)), "bandit")
