"""Agreement with the bandits of river (Montiel et al. 2021) on the same rewards and the same random numbers.

Where river's policy is the same algorithm its choices have to be ours, one by one: its source of randomness is replaced
by one that hands out the row's own draws. Where it is another one (its Thompson sampling draws from the distribution of
the rewards, not of their mean; its LinUCB adds the noise of a reward to the bound), what both estimate is compared.
"""

import numpy as np
import pytest

from selector.strategies.problem import Problem
from selector.strategies.registry import create
from selector.strategies.streams import row_keys, uniforms

bandit = pytest.importorskip("river.bandit", reason="river is not installed (extra dev)")
pytestmark = pytest.mark.extra

ARMS = (0, 1, 2, 3)
MEANS = np.array([0.3, 0.45, 0.5, 0.2])
NO_CONTEXT = np.zeros((1, 0))


class OurDraws:
    """Stands in for random.Random: uniform numbers are those of the row's decision."""

    def __init__(self, strategy):
        self.strategy = strategy
        self.used = 0

    def next(self):
        counters = self.strategy.counters - np.uint64(1)  # the strategy has decided before river does
        self.used += 1
        return uniforms(self.strategy.keys, counters, self.used)[0, self.used - 1]

    def uniform(self, low, high):
        return low + (high - low) * self.next()

    def choice(self, options):
        return options[int(self.next() * len(options))]

    def choices(self, options, weights):
        return [options[int(np.searchsorted(np.cumsum(list(weights)), self.next(), side="right"))]]


def made(name, parameters, features=()):
    problem = Problem("Goal", tuple("abcd"), np.zeros(4), features)
    return create(name, problem, row_keys(np.random.SeedSequence(11), 1), parameters)


def together(strategy, policy, draws=OurDraws, steps=2000, seed=5):
    """Let both decide and learn; return the options (steps,), which have to be the same."""
    generator, chosen = np.random.default_rng(seed), []
    policy._rng = draws(strategy)
    for _ in range(steps):
        option = strategy.select(NO_CONTEXT)
        policy._rng.used = 0
        arm = policy.pull(list(ARMS))
        assert arm == option[0]
        reward = float(np.clip(MEANS[arm] + 0.2 * generator.normal(), 0.0, 1.0))
        policy.update(arm, reward)
        strategy.update(option, np.array([reward]), NO_CONTEXT)
        chosen.append(arm)
    assert len(set(chosen)) > 1
    return np.array(chosen)


@pytest.mark.parametrize("decay", [0.0, 0.002])
def test_epsilon_greedy_takes_the_same_options(decay):
    strategy = made("EpsilonGreedy", {"epsilon": 0.3, "decay": decay, "prior": 0.0})
    policy = bandit.EpsilonGreedy(epsilon=0.3, decay=decay)
    together(strategy, policy)
    np.testing.assert_allclose(strategy.estimates()[0], [policy._rewards[arm].get() for arm in ARMS], rtol=1e-10)


@pytest.mark.parametrize("delta", [0.3, 1.0])
def test_ucb1_takes_the_same_options(delta):
    strategy, policy = made("UCB1", {"exploration": delta, "prior": 0.0}), bandit.UCB(delta=delta)

    class First(OurDraws):
        def choice(self, options):
            return options[0]  # of equal bounds ours is the first; river draws one

    together(strategy, policy, First)
    np.testing.assert_array_equal(strategy.counts[0], [policy._counts[arm] for arm in ARMS])


@pytest.mark.parametrize("gamma", [0.05, 0.4])
def test_exp3_takes_the_same_options(gamma):
    strategy, policy = made("EXP3", {"gamma": gamma, "prior": 0.0}), bandit.Exp3(gamma=gamma)
    for arm in ARMS:
        policy._weights[arm] = 1.0  # river counts an arm from its first pull on; all of them take part here
    together(strategy, policy)
    weights = np.array([policy._weights[arm] for arm in ARMS])
    np.testing.assert_allclose(np.exp(strategy.log_weights[0]), weights / weights.max(), rtol=1e-8)
