"""Strategies that learn lose ever less: regret on synthetic bandits, with fixed seeds and generous bounds."""

import numpy as np
import pytest

from tests.selector.strategies.bandits import constant, linear, regrets, switching

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


@pytest.mark.long
@pytest.mark.parametrize("name", ["UCB1", "GaussianThompson"])
def test_regret_grows_with_the_logarithm_of_time(name):
    total = np.cumsum(regrets(name, STATIONARY[name], constant(*MEANS), steps=4000))
    # equal ratios of time bring about equal regret: 250 to 1000 and 1000 to 4000
    assert total[3999] - total[999] < 1.6 * (total[999] - total[249])


def test_what_learns_nothing_loses_all_the_time():
    for name in ("Random", "MaxScore"):
        quarters = regrets(name, {}, constant(*MEANS), steps=STEPS).reshape(4, -1).mean(axis=1)
        assert quarters[3] > 0.9 * quarters[0] > 0.0


ADAPTING = {
    "DiscountedUCB": {"discount": 0.98, "exploration": 0.15, "prior": 0.1},
    "SlidingWindowUCB": {"window": 150, "exploration": 0.3, "prior": 0.1},
}
PERIOD = 400


@pytest.mark.long
@pytest.mark.parametrize("name", list(ADAPTING))
def test_strategies_that_forget_adapt_after_every_change(name):
    change = switching(PERIOD, 0.3, 0.8)
    lost = regrets(name, ADAPTING[name], change, steps=10 * PERIOD).reshape(10, PERIOD)
    assert (lost[:, -100:].mean(axis=1) < 0.1 * 0.25).all()  # a random choice loses 0.25
    assert (lost[1:, :5].mean(axis=1) > 0.25).all()  # what was right is wrong now
    faithful = regrets("GaussianThompson", STATIONARY["GaussianThompson"], change, steps=10 * PERIOD)
    assert lost[1:].mean() < 0.5 * faithful[PERIOD:].mean()


SLOPES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-0.7, -0.7, 0.0))


@pytest.mark.parametrize("name", ["LinUCB", "LinearThompson"])
def test_strategies_with_a_context_learn_what_it_means(name):
    lost = regrets(name, STATIONARY[name], linear(*SLOPES), steps=1500, features=3)
    quarters = lost.reshape(3, -1).mean(axis=1)
    blind = regrets("UCB1", {}, linear(*SLOPES), steps=500, features=3).mean()
    assert quarters[0] < 0.2 * blind
    assert quarters[2] < 0.5 * quarters[0]
    assert quarters[2] < 0.02 * blind


@pytest.mark.long
def test_the_expert_saves_regret_when_right_and_is_overcome_when_wrong():
    parameters = {"exploration": 0.5, "prior": 5.0}
    lost = {
        name: regrets("UCB1", parameters, constant(*MEANS), steps=2000, scores=np.array(scores))
        for name, scores in (("right", MEANS), ("wrong", (0.8, 0.2, 0.3, 0.5)))
    }
    assert lost["right"].sum() < 0.8 * lost["wrong"].sum()
    assert lost["wrong"][-500:].mean() < 0.05 * ANYTHING
