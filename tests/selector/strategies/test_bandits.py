"""The strategies that learn against their formulas, written out for one row and one reward at a time."""

import math

import numpy as np
import pytest
from scipy import stats

from selector.strategies.problem import Problem
from selector.strategies.registry import create
from selector.strategies.streams import row_keys, uniforms

SCORES = (0.3, 0.6, 0.1)
NO_CONTEXT = np.zeros((1, 0))


def made(name, parameters=None, *, seed=0, features=(), scores=SCORES):
    problem = Problem("Goal", tuple("abcd"[: len(scores)]), np.array(scores), features)
    return create(name, problem, row_keys(np.random.SeedSequence(seed), 1), parameters)


def history(steps=300, options=3, seed=1):
    """Return which option was rewarded, and how (steps,)."""
    generator = np.random.default_rng(seed)
    option = generator.integers(options, size=steps)
    return option, np.array([0.2, 0.5, 0.4])[option] + 0.3 * generator.normal(size=steps)


def follow(strategy, formula, steps=300):
    """Let the strategy decide after every reward and compare with what `formula(options, rewards)` would take."""
    option, reward = history(steps)
    for t in range(steps):
        chosen = int(strategy.select(NO_CONTEXT)[0])
        values = formula(option[:t], reward[:t])
        assert values[chosen] == pytest.approx(max(values), rel=1e-9), t
        strategy.update(option[t : t + 1], reward[t : t + 1], NO_CONTEXT)


def bounds(pulls, sums, prior, width):
    """Return upper confidence bounds, or, while an option was not tried, the scores of those."""
    pulls = [n + prior for n in pulls]
    if any(n == 0 for n in pulls):
        return [SCORES[k] if pulls[k] == 0 else -math.inf for k in range(3)]
    means = [(sums[k] + prior * SCORES[k]) / pulls[k] for k in range(3)]
    return [means[k] + width * math.sqrt(math.log(max(sum(pulls), 1.0)) / pulls[k]) for k in range(3)]


LIMITS = {"exploration": 0.4, "confidence": 0.6}
WEIGHTED = {
    "UCB1": ({"exploration": 0.7}, np.ones, 0.7 * math.sqrt(2.0)),
    "DiscountedUCB": (
        {**LIMITS, "discount": 0.95},
        lambda steps: 0.95 ** np.arange(steps - 1, -1, -1),
        2 * 0.4 * math.sqrt(0.6),
    ),
    "SlidingWindowUCB": ({**LIMITS, "window": 20}, lambda steps: np.arange(steps) >= steps - 20, 0.4 * math.sqrt(0.6)),
}
"""Strategy -> parameters, what each reward weighs after some steps, and the width of its bound."""


@pytest.mark.parametrize("prior", [0.0, 0.1, 2.5])
@pytest.mark.parametrize("name", WEIGHTED)
def test_upper_confidence_bounds(name, prior):
    parameters, weights, width = WEIGHTED[name]

    def formula(option, reward):
        weight = weights(len(option))
        pulls = [weight[option == k].sum() for k in range(3)]
        return bounds(pulls, [(weight * reward)[option == k].sum() for k in range(3)], prior, width)

    follow(made(name, {"prior": prior, **parameters}), formula)


def test_rewards_of_one_group_discount_no_other_group():
    problem = Problem("Goal", tuple("abc"), np.array(SCORES), ())
    keys, groups = row_keys(np.random.SeedSequence(0), 2), np.array([0, 1])
    strategy = create("DiscountedUCB", problem, keys, {"discount": 0.5}, groups=groups)
    both = np.zeros((2, 0))
    for reward in ([1.0, 2.0], [np.nan, 3.0]):
        strategy.select(both)
        known = np.isfinite(reward)
        strategy.update(np.array([1, 2])[known], np.array(reward)[known], both[known], rows=np.flatnonzero(known))
    assert strategy.counts.tolist() == [[0.0, 1.0, 0.0], [0.0, 0.0, 1.5]]
    assert strategy.totals.tolist() == [[0.0, 1.0, 0.0], [0.0, 0.0, 4.0]]


def test_the_sums_of_a_sliding_window_do_not_drift():
    strategy = made("SlidingWindowUCB", {"window": 7})
    generator = np.random.default_rng(0)
    option, reward = generator.integers(3, size=5000), 1e6 * generator.normal(size=5000)
    for t in range(5000):
        strategy.update(option[t : t + 1], reward[t : t + 1], NO_CONTEXT)
    state = strategy.learned()
    np.testing.assert_allclose(state["totals"], state["step_totals"].sum(axis=1), atol=1e-8)
    assert state["counts"].sum() == 7


def test_forgetting_does_not_depend_on_the_size_of_the_team():
    """A step is one update of a group: the same rewards of two robots at once weigh twice and are forgotten alike."""
    for name in ("DiscountedUCB", "SlidingWindowUCB"):
        problem = Problem("Goal", ("a", "b", "c"), np.array(SCORES))
        parameters = {"prior": 0.0, "window": 20} if name.startswith("Sliding") else {"prior": 0.0}
        alone = create(name, problem, np.zeros(1, np.uint64), parameters)
        team = create(name, problem, np.zeros(2, np.uint64), parameters)
        option, reward = history(60)
        for t in range(60):
            alone.update(option[t : t + 1], reward[t : t + 1], NO_CONTEXT)
            team.update(option[[t, t]], reward[[t, t]], np.zeros((2, 0)))
        np.testing.assert_allclose(team.estimates(), alone.estimates(), rtol=1e-12)
        np.testing.assert_allclose(team.learned()["counts"], 2 * alone.learned()["counts"], rtol=1e-12)


@pytest.mark.parametrize("decay", [0.0, 0.02])
def test_epsilon_greedy(decay):
    strategy = made("EpsilonGreedy", {"epsilon": 0.4, "decay": decay, "prior": 1.5}, seed=4)
    option, reward = history()
    explored = 0
    for t in range(300):
        draws = uniforms(strategy.keys, np.array([t], np.uint64), 2)[0]
        means = [
            (reward[:t][option[:t] == k].sum() + 1.5 * SCORES[k]) / ((option[:t] == k).sum() + 1.5) for k in range(3)
        ]
        explores = draws[0] < 0.4 * math.exp(-decay * t)
        explored += explores
        expected = int(draws[1] * 3) if explores else int(np.argmax(means))
        assert strategy.select(NO_CONTEXT)[0] == expected
        strategy.update(option[t : t + 1], reward[t : t + 1], NO_CONTEXT)
    assert 10 < explored < 160


def test_without_a_prior_the_score_holds_until_the_first_reward():
    strategy = made("EpsilonGreedy", {"epsilon": 0.0, "prior": 0.0})
    np.testing.assert_array_equal(strategy.estimates(), [SCORES])
    strategy.update(np.array([1]), np.array([-4.0]), NO_CONTEXT)
    np.testing.assert_array_equal(strategy.estimates(), [[0.3, -4.0, 0.1]])


def test_mean_and_spread_of_large_rewards_are_exact():
    strategy, (option, reward) = made("UCB1"), history(2000)
    reward = reward + 1e8  # a sum of squares would have lost all digits of the spread
    for t in range(0, 2000, 50):
        rows = np.zeros(50, int)
        strategy.update(option[t : t + 50], reward[t : t + 50], np.zeros((50, 0)), rows)
    for k in range(3):
        assert strategy.means[0, k] == pytest.approx(reward[option == k].mean(), rel=1e-14)
        assert strategy.spreads[0, k] == pytest.approx((reward[option == k].var() * (option == k).sum()), rel=1e-6)


def normal_inverse_gamma(option, reward, prior, shape, deviation):
    """Return location, scale and degrees of freedom of each option's mean, reward by reward."""
    results = []
    for k in range(3):
        location, kappa, alpha, beta = SCORES[k], prior, shape, shape * deviation**2
        for value in reward[option == k]:
            beta += kappa * (value - location) ** 2 / (2 * (kappa + 1))
            location = (kappa * location + value) / (kappa + 1)
            kappa, alpha = kappa + 1, alpha + 0.5
        results.append((location, math.sqrt(beta / (alpha * kappa)), 2 * alpha))
    return np.array(results).T


def test_gaussian_thompson_has_the_posterior_of_the_conjugate_prior():
    strategy, (option, reward) = made("GaussianThompson", {"prior": 0.5, "shape": 2.0, "deviation": 0.7}), history()
    for t in range(300):
        strategy.update(option[t : t + 1], reward[t : t + 1], NO_CONTEXT)
        if t % 37 == 0:
            expected = normal_inverse_gamma(option[: t + 1], reward[: t + 1], 0.5, 2.0, 0.7)
            np.testing.assert_allclose(np.array(strategy.posterior())[:, 0], expected, rtol=1e-10)


def test_gaussian_thompson_takes_options_as_often_as_they_are_likely_to_be_best():
    rows = 20_000
    problem = Problem("Goal", ("a", "b", "c"), np.array(SCORES))
    strategy = create("GaussianThompson", problem, row_keys(np.random.SeedSequence(2), rows))
    option, reward = history(30)
    strategy.update(option, reward, np.zeros((30, 0)), np.zeros(30, int))
    counts = np.bincount(strategy.select(np.zeros((rows, 0))), minlength=3)
    location, scale, freedom = normal_inverse_gamma(option, reward, 1.0, 1.0, 1.0)
    grid = np.linspace(-15, 15, 200_001)
    laws = [stats.t(freedom[k], location[k], scale[k]) for k in range(3)]
    below = [law.cdf(grid) for law in laws]
    for k in range(3):
        others = np.prod([below[j] for j in range(3) if j != k], axis=0)
        likely = np.trapezoid(laws[k].pdf(grid) * others, grid)
        # five standard deviations: a false alarm in a million
        assert abs(counts[k] / rows - likely) < 5 * math.sqrt(likely * (1 - likely) / rows)


def test_exp3():
    strategy = made("EXP3", {"gamma": 0.2, "lowest": -1.0, "highest": 1.0, "prior": 2.0}, seed=9)
    weights = [math.exp(0.2 * 2.0 * (score + 1.0) / 2.0) for score in SCORES]
    _, reward = history()
    for t in range(300):
        chances = [0.8 * w / sum(weights) + 0.2 / 3 for w in weights]
        draw = uniforms(strategy.keys, np.array([t], np.uint64), 1)[0, 0]
        expected = int(np.searchsorted(np.cumsum(chances), draw, side="right"))
        option = strategy.select(NO_CONTEXT)
        assert option[0] == expected
        assert strategy.chance[0] == pytest.approx(chances[expected], rel=1e-9)
        strategy.update(option, reward[t : t + 1], NO_CONTEXT)
        scaled = min(max((reward[t] + 1.0) / 2.0, 0.0), 1.0)
        weights[expected] *= math.exp(0.2 * scaled / chances[expected] / 3)


def test_exp3_never_overflows():
    strategy = made("EXP3", {"gamma": 1.0})
    for _ in range(3000):
        strategy.update(np.array([1]), np.array([1e9]), NO_CONTEXT, chance=np.array([0.01]))
    assert np.isfinite(strategy.learned()["log_weights"]).all()
    assert strategy.learned()["log_weights"].max() == 0.0


def contextual(steps=400, width=4, seed=3):
    generator = np.random.default_rng(seed)
    context = generator.normal(size=(steps, width))
    option = generator.integers(3, size=steps)
    slopes = generator.normal(size=(3, width))
    return context, option, (context * slopes[option]).sum(axis=1) + 0.1 * generator.normal(size=steps)


def ridge(context, option, reward, prior, k):
    """Return A and weights of the regression of option k, by solving its equations anew."""
    x = np.column_stack([np.ones(len(context)), context])[option == k]
    start = np.zeros(x.shape[1])
    start[0] = SCORES[k]
    a = prior * np.eye(x.shape[1]) + x.T @ x
    return a, np.linalg.solve(a, prior * start + x.T @ reward[option == k])


@pytest.mark.parametrize("name", ["LinUCB", "LinearThompson"])
def test_linear_models_are_the_ridge_regression(name):
    strategy = made(name, {"prior": 0.7, "exploration": 1.3}, features=tuple("wxyz"))
    context, option, reward = contextual()
    for t in range(400):
        now = slice(t, t + 1)
        if t % 41 == 0:
            x = np.array([1.0, *context[t]])
            models = [ridge(context[:t], option[:t], reward[:t], 0.7, k) for k in range(3)]
            expected = np.array([weights @ x for _, weights in models])
            error = np.array([math.sqrt(x @ np.linalg.solve(a, x)) for a, _ in models])
            if name == "LinUCB":
                values = expected + 1.3 * error
            else:
                draws = uniforms(strategy.keys, strategy.counters, 6)[0].reshape(3, 2)
                normal = np.sqrt(-2 * np.log(1 - draws[:, 0])) * np.cos(2 * np.pi * draws[:, 1])
                values = expected + 1.3 * error * normal
            assert strategy.select(context[now])[0] == values.argmax()
            np.testing.assert_allclose(strategy.weights[0], [weights for _, weights in models], rtol=1e-9, atol=1e-12)
        strategy.update(option[now], reward[now], context[now])


def test_linear_models_stay_exact_over_many_rewards():
    strategy = made("LinUCB", {"prior": 0.01}, features=tuple("wxyz"))
    context, option, reward = contextual(100_000)
    strategy.update(option, reward, context, np.zeros(100_000, int))
    for k in range(3):
        a, weights = ridge(context, option, reward, 0.01, k)
        np.testing.assert_allclose(strategy.inverse[0, k] @ a, np.eye(5), atol=1e-8)
        np.testing.assert_allclose(strategy.weights[0, k], weights, rtol=1e-8)
        np.testing.assert_array_equal(strategy.inverse[0, k], strategy.inverse[0, k].T)
