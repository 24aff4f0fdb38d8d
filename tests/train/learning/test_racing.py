"""The race keeps the better candidate and saves missions; the noise is that of missions."""

import numpy as np
import pytest

from train.learning.racing import RaceConfig, front, race, worse_than_best

pytest.importorskip("optuna", reason="optuna is not installed (extra tune)")

from tests.train.studies.synthetic import NOISE
from train.studies.missions import Candidate

RULES = RaceConfig(block=10, blocks=10)


def test_of_twenty_candidates_the_one_that_is_a_tenth_better_survives_half_of_the_missions():
    good = 0
    for seed in range(20):
        rng, missions = np.random.default_rng(seed), {}
        better = int(rng.integers(20))
        costs = np.exp(rng.normal(0.0, NOISE, (20, RULES.block * RULES.blocks)))
        costs[better] *= 0.9

        def measure(alive, count, costs=costs, missions=missions):
            missions.update({one.name: count for one in alive})
            return costs[[int(one.name) for one in alive], None, :count]

        left = race([Candidate(str(k), {}) for k in range(20)], measure, RULES)
        good += str(better) in {one.name for one in left} and sum(missions.values()) <= costs.size / 2
    assert good >= 18


def test_equal_candidates_stay():
    costs = np.tile(np.random.default_rng(0).normal(100.0, 30.0, 20), (4, 1, 1))
    assert not worse_than_best(costs, 0.05).any()
    assert worse_than_best(np.concatenate([costs, costs + 1.0]), 0.05).tolist() == [False] * 4 + [True] * 4


def test_who_is_better_in_one_of_two_figures_stays():
    duration, events = np.full(10, 50.0), np.full(10, 5.0)
    noise = np.random.default_rng(0).normal(0.0, 1.0, (3, 2, 10))
    figures = np.array([[duration, 2 * events], [2 * duration, events], [3 * duration, 3 * events]]) + noise
    assert worse_than_best(figures, 0.05).tolist() == [False, False, True]
    assert front(figures.mean(axis=-1)).tolist() == [0, 1]
