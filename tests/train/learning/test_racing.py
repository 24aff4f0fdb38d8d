"""The race keeps the better candidate and saves missions; the noise is that of missions."""

import numpy as np

from train.learning.racing import RaceConfig, race, worse_than_best

NOISE = 0.2
"""Standard deviation of the logarithm of the cost of one option, as on `random` (decision 0172)."""
RULES = RaceConfig(block=10, blocks=10)


def test_of_twenty_candidates_the_one_that_is_a_tenth_better_survives_half_of_the_missions():
    good = 0
    for seed in range(20):
        rng, missions = np.random.default_rng(seed), {}
        better = int(rng.integers(20))
        costs = np.exp(rng.normal(0.0, NOISE, (20, RULES.block * RULES.blocks)))
        costs[better] *= 0.9

        def measure(alive, count, costs=costs, missions=missions):
            missions.update(dict.fromkeys(alive, count))
            return costs[list(alive), :count]

        left = race(20, measure, RULES)
        good += better in left and sum(missions.values()) <= costs.size / 2
    assert good >= 18


def test_equal_candidates_stay():
    costs = np.tile(np.random.default_rng(0).normal(100.0, 30.0, 20), (4, 1))
    assert not worse_than_best(costs, 0.05).any()
    assert worse_than_best(np.concatenate([costs, costs + 1.0]), 0.05).tolist() == [False] * 4 + [True] * 4
