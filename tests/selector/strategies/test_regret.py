"""Strategies that learn lose ever less: regret on synthetic bandits, with fixed seeds and generous bounds."""

import numpy as np
import pytest

from tests.selector.strategies.bandits import constant, linear, regrets

MEANS = (0.2, 0.8, 0.5, 0.3)
STATIONARY = {
    "EpsilonGreedy": {"epsilon": 0.5, "decay": 0.01},
    "UCB1": {"exploration": 0.5},
    "GaussianThompson": {"deviation": 0.25},
    "EXP3": {"gamma": 0.05},
    "LinUCB": {"exploration": 1.0},
    "LinearThompson": {"exploration": 0.25},
    # without forgetting they are UCB1 with another width
    "DiscountedUCB": {"discount": 1.0, "exploration": 0.25},
    "SlidingWindowUCB": {"window": 3000, "exploration": 0.5},
}
STEPS = 3000
ANYTHING = 0.8 - np.mean(MEANS)  # regret of a random choice


@pytest.mark.parametrize("name", list(STATIONARY))
def test_regret_grows_more_slowly_than_time(name):
    lost = regrets(name, STATIONARY[name], constant(*MEANS), steps=STEPS)
    quarters = lost.reshape(4, -1).mean(axis=1)
    assert quarters[0] < 0.75 * ANYTHING
    assert quarters[3] < 0.4 * quarters[0]
    assert quarters[3] < 0.15 * ANYTHING


SLOPES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-0.7, -0.7, 0.0))


@pytest.mark.parametrize("name", ["LinUCB", "LinearThompson"])
def test_strategies_with_a_context_learn_what_it_means(name):
    lost = regrets(name, STATIONARY[name], linear(*SLOPES), steps=1500, features=3)
    quarters = lost.reshape(3, -1).mean(axis=1)
    blind = regrets("UCB1", {}, linear(*SLOPES), steps=500, features=3).mean()
    assert quarters[0] < 0.2 * blind
    assert quarters[2] < 0.5 * quarters[0]
    assert quarters[2] < 0.02 * blind
