"""Sign flips: exact p-values, corrections, and how often equal strategies are told apart, by simulation."""

import itertools
from math import comb

import numpy as np
import pytest

from tests.train.analysis.equal_strategies import COUNTS, JAMS, OWN, equal_table, share_told, told_apart
from train.analysis.flips import ALPHA, Flips, fewest, holm
from train.analysis.intervals import Ratio, corrected_ps
from train.analysis.verdict import Ranking, most_left

HIGHEST = 0.065
"""Highest share of tables of equal strategies in which any two may be told apart."""


def test_every_way_to_flip_signs_is_counted():
    own = np.array([0.5, -0.1, 0.3, 0.0, 0.2])
    sums = [abs(np.dot(signs, own)) for signs in itertools.product((-1, 1), repeat=5)]
    assert Flips(own).p == np.mean(np.array(sums) >= own.sum() - 1e-12)
    assert Flips(np.arange(1.0, 6.0)).p == 2 / 32  # five scenarios that agree
    assert Flips(np.zeros(9)).p == Flips(np.zeros(9)).least == 1.0


@pytest.mark.parametrize(("lost", "won"), [(0, 6), (2, 9), (7, 9), (1, 15)])
def test_shares_of_unfinished_missions_have_mcnemars_exact_p_value(lost, won):
    left = np.zeros((2, 1, 60, 1))
    left[0, 0, :lost], left[1, 0, lost : lost + won] = 1.0, 1.0
    test = Ratio.of(np.ones((1, 60, 1)), np.ones((1, 60, 1)), tuple(left)).tests[1]
    assert test.p == pytest.approx(min(2.0 * sum(comb(lost + won, k) for k in range(lost + 1)) / 2 ** (lost + won), 1))


def test_more_scenarios_than_can_be_enumerated_are_drawn_and_the_same_each_time():
    own = np.random.default_rng(1).normal(0.3, 1.0, 40)
    assert Flips(own).p == Flips(own.copy()).p
    assert Flips(own).p == pytest.approx(0.0585, abs=0.02)  # 0.0585 by Student's t
    assert Flips(np.abs(own)).p == Flips(np.abs(own)).least


def test_tests_that_cannot_be_significant_do_not_count():
    assert holm([0.002] * 2 + [1.0] * 50, [0.002] * 2 + [0.5] * 50)[:2] == [0.004, 0.004]
    for pairs, scenarios in ((1, 6), (15, 10)):
        assert fewest(pairs) == scenarios
        least = 2.0 / 2**scenarios
        assert (
            max(holm([least] * pairs, [least] * pairs)) < ALPHA <= min(holm([2 * least] * pairs, [2 * least] * pairs))
        )


def test_missions_that_one_of_both_leaves_unfinished_count_by_their_share_alone():
    rng = np.random.default_rng(2)
    a = rng.lognormal(0.0, 0.3, 30)
    b, lost = 1.5 * a, np.zeros(30)
    lost[:12] = 1.0
    whole = Ratio.of(np.where(lost, 100.0, a), b, (lost, np.zeros(30)))
    assert [test.sign for test in whole.tests] == [-1.0, 1.0]
    assert len(whole.tests[0].differences) == 18
    assert whole.p == 2 / 2**12  # jams make a cost more on average; only the shares have that sign
    assert corrected_ps([whole] * 15)[0] > whole.p


def test_worlds_of_a_scenario_count_once_and_trainings_by_their_spread():
    rng = np.random.default_rng(3)
    other = rng.lognormal(0.0, 0.2, (1, 8, 5))
    own = other * np.exp(rng.normal(0.1, 0.2, (1, 8, 1)))
    (test,) = Ratio.of(own, other).tests
    assert len(test.differences) == 8
    (several,) = Ratio.of(own * np.array([0.5, 1.0, 2.0])[:, None, None], other).tests
    assert several.p > 0.5 > test.p
    (alike,) = Ratio.of(np.repeat(own, 3, axis=0), other).tests
    assert alike.p == pytest.approx(test.p)


def test_the_simulation_tells_what_a_ranking_tells():
    rng, pairs = np.random.default_rng(4), list(itertools.combinations(range(3), 2))
    costs = rng.lognormal(0.0, 0.5, (30, 3, 20)) * np.array([1.0, 1.4, 1.4])[:, None]
    jams = rng.uniform(size=costs.shape) < np.array([0.0, 0.1, 0.3])[:, None]
    found = told_apart(costs, jams, pairs)
    assert 0.1 < found.mean() < 0.9
    for own, lost, tells in zip(np.where(jams, 10.0, costs), jams * 1.0, found, strict=True):
        left = {name: lost[k][None, :, None] for k, name in enumerate("abc")}
        ranking = Ranking.of(dict(zip("abc", own, strict=True)), left=left)
        assert [ranking.apart("abc"[a], "abc"[b]) for a, b in pairs] == tells.tolist()


def test_equal_strategies_are_seldom_told_apart_and_different_ones_are():
    for jam, strategies in ((0.0, 2), (0.05, 2), (0.2, 6)):
        share, _ = share_told(OWN["log-normal, 1"], 10, [jam] * strategies, [1.0] * strategies, (5,), 400)
        assert share < 0.08  # 400 tables: three standard errors above 5 %
    assert share_told(OWN["log-normal, 0.25"], 30, (0.0, 0.0), (1.0, 1.3), (6,), 200)[0] > 0.9
    assert share_told(OWN["log-normal, 0.25"], 30, (0.0, 0.5), (1.0, 1.0), (7,), 200)[0] > 0.9


@pytest.mark.long
def test_no_cell_of_the_simulation_tells_equal_strategies_apart_too_often():
    found = equal_table()
    assert len(found) == len(OWN) * len(JAMS) * 2 * len(COUNTS)
    assert {cell: share for cell, (share, _) in found.items() if share > HIGHEST} == {}


@pytest.mark.parametrize(("lost", "scenarios", "bound"), [(0, 30, 0.095), (1, 20, 0.216), (12, 12, 1.0)])
def test_how_many_missions_may_be_unfinished(lost, scenarios, bound):
    left = (np.arange(scenarios) < lost).astype(float)[None, :, None]
    assert most_left(left) == pytest.approx(bound, abs=5e-4)


def test_intervals_that_heavy_tails_spoil_say_so():
    costs = np.random.default_rng(8).normal(100.0, 10.0, 30)
    jammed = costs.copy()
    jammed[3] = 2_000.0
    assert Ranking.of({"a": costs, "b": jammed}).heavy == ["b"]
    assert "(too narrow: heavy tails)" in Ranking.of({"b": jammed}).sentences()[0]
