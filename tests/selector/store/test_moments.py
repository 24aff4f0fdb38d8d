"""Exact sums: what they are, and that no order of adding changes a bit."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from selector.store.exact_sums import COUNT_LIMIT, GRID_BITS, Moments, RewardSums, on_grid
from tests.selector.store import strategies as some


@given(st.lists(some.rewards, min_size=1, max_size=20))
def test_sums_mean_and_variance_are_those_of_fractions(values):
    grid = [Fraction(int(whole), 2**GRID_BITS) for whole in on_grid(np.array(values))]
    assert all(abs(g - Fraction(v)) <= Fraction(1, 2 ** (GRID_BITS + 1)) for g, v in zip(grid, values, strict=True))
    moments = some.moments_of(values)
    assert moments.count == len(values)
    assert Fraction(moments.total, 2**GRID_BITS) == sum(grid)
    assert Fraction(moments.squares, 2 ** (2 * GRID_BITS)) == sum(g * g for g in grid)
    mean = sum(grid) / len(grid)
    assert moments.mean == float(mean)
    assert moments.variance == float(sum((g - mean) ** 2 for g in grid) / len(grid))
    assert moments.impossible() == ""


@given(st.lists(some.moments, min_size=1, max_size=6), st.randoms(use_true_random=False))
def test_adding_is_exact_in_any_order_and_grouping(parts, random):
    forwards = sum(parts, Moments(0, 0, 0))
    random.shuffle(parts)
    while len(parts) > 1:
        k = random.randrange(len(parts) - 1)
        parts[k : k + 2] = [parts[k] + parts[k + 1]]
    assert parts[0] == forwards


def test_sums_of_more_rows_than_fit_into_64_bits():
    many = 2**12
    sums = RewardSums("G", ["a", "b"])
    sums.record(np.arange(2 * many + 3) % 2, np.full(2 * many + 3, -(2.0**20)))
    assert sums.moments["a"] == Moments(many + 2, -(many + 2) * 2**44, (many + 2) * 2**88)
    assert sums.moments["b"] == Moments(many + 1, -(many + 1) * 2**44, (many + 1) * 2**88)


@given(st.lists(st.tuples(st.integers(0, 1), some.rewards), max_size=12))
def test_a_batch_sums_rows_by_option(updates):
    batch, single = RewardSums("Avoid", ["near", "far"]), RewardSums("Avoid", ["near", "far"])
    option, reward = np.array([one[0] for one in updates], dtype=int), np.array([one[1] for one in updates])
    batch.record(option, reward)
    for k in range(len(updates)):
        single.record(option[k : k + 1], reward[k : k + 1])
    assert batch.moments == single.moments
    assert batch.count == len(updates)
    for name, moments in batch.moments.items():
        assert moments == some.moments_of(reward[option == ["near", "far"].index(name)])


@pytest.mark.parametrize("reward", [math.nan, math.inf, -math.inf, 2.0**20 + 1, -1e300])
def test_rewards_that_fit_nowhere_are_refused_and_nothing_is_recorded(reward):
    batch = RewardSums("G", ["a"])
    with pytest.raises(ValueError, match=r"reward of row 1: expected a number from -1048576 to 1048576, got "):
        batch.record(np.array([0, 0]), np.array([1.0, reward]))
    assert batch.moments == {}


@pytest.mark.parametrize(
    ("moments", "message"),
    [
        (Moments(0, 0, 0), "expected a count from 1 to 68719476736, got 0"),
        (Moments(COUNT_LIMIT + 1, 0, 0), "expected a count"),
        (Moments(1, 2**44 + 1, 2**88), "expected a sum of at most"),
        (Moments(2, 4, 7), "do not belong to 2 rewards"),
        (Moments(2, 0, -1), "do not belong"),
        (Moments(2, 0, 2**89 + 1), "do not belong"),
    ],
)
def test_moments_of_no_rewards_are_recognised(moments, message):
    assert message in moments.impossible()


@pytest.mark.parametrize(
    ("option", "reward", "message"),
    [
        ([2], [0.0], r"unknown option '2' \(known: 0, 1"),
        ([-1], [0.0], "unknown option '-1'"),
        ([0.0], [0.0], r"option: expected integers \(R,\), got \(1,\) of float64"),
        ([[0]], [[0.0]], r"option: expected integers \(R,\), got \(1, 1\)"),
        ([0, 1], [0.0], r"reward: expected shape \(2,\), got \(1,\)"),
    ],
)
def test_updates_that_do_not_fit_are_refused(option, reward, message):
    with pytest.raises(ValueError, match=message):
        RewardSums("G", ["a", "b"]).record(np.array(option), np.array(reward))
