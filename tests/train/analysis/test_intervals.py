"""Ratios of means by the number of scenarios: how often they are right, by simulation, and when nothing is said."""

import numpy as np
import pytest

from train.analysis.flips import fewest
from train.analysis.intervals import TOLD, Ratio

FEWEST = fewest(1)


def pairs(rng, scenarios, ratio=1.0):
    """Costs that two strategies have on the same scenarios, which differ more than the strategies do."""
    common = rng.gamma(4.0, size=scenarios)
    own, other = common * rng.gamma(18.0, 1 / 18, size=(2, scenarios))
    return ratio * own, other


@pytest.mark.parametrize("scenarios", [2, 3, 6, 30])
def test_intervals_hold_the_truth_as_often_as_they_say_for_any_number_of_scenarios(scenarios):
    rng, repeats = np.random.default_rng(5), 300
    found = [Ratio.of(*pairs(rng, scenarios, 2.0)).ci95 for _ in range(repeats)]
    assert 0.89 <= np.mean([low <= 2.0 <= high for low, high in found]) <= 0.99


@pytest.mark.parametrize("scenarios", range(1, FEWEST))
def test_of_few_scenarios_nothing_is_said(scenarios):
    few = Ratio.of(*pairs(np.random.default_rng(7), scenarios, 6.58))
    assert few.p is None
    enough = Ratio.of(*pairs(np.random.default_rng(7), FEWEST, 6.58))
    assert enough.p == 2 / 2**FEWEST


def test_so_many_scenarios_as_are_needed_tell_a_tenth_four_times_in_five():
    rng, repeats = np.random.default_rng(8), 300
    needed = Ratio.of(*pairs(rng, 20_000)).tests[0].needed(TOLD)
    assert 80 < needed < 200
    told = [Ratio.of(*pairs(rng, needed, 1.1)).p < 0.05 for _ in range(repeats)]
    assert 0.7 < np.mean(told) < 0.9
    guessed = [Ratio.of(*pairs(rng, 5)).tests[0].needed(TOLD) for _ in range(repeats)]  # from five scenarios
    assert 0.5 * needed < np.median(guessed) < 1.5 * needed


def test_a_ratio_to_nothing_is_absent_and_never_infinite():
    assert Ratio.of(np.array([1.0, 2.0]), np.zeros(2)).content == {"ratio": None, "ci95": None, "p": None}
    assert Ratio.of(np.zeros(7), np.ones(7)).content == {"ratio": 0.0, "ci95": None, "p": 2 / 2**7}
    low, high = Ratio.of(np.ones(4), np.array([1.0, 0.0, 0.0, 0.0])).ci95
    assert 0.0 < low < 4.0 < high < np.inf
    assert Ratio.of(np.array([3.0]), np.array([2.0])).content == {"ratio": 1.5, "ci95": None, "p": None}


def test_scenarios_are_paired():
    a = np.array([1.0, 10.0, 100.0, 5.0, 7.0, 20.0])
    assert Ratio.of(3.0 * a, a).ci95 == pytest.approx((3.0, 3.0))
    assert Ratio.of(3.0 * a, a).p == 2 / 2**6
    assert Ratio.of(a, a).p == 1.0
    low, high = Ratio.of(3.0 * a[::-1], a).ci95
    assert low < 1.0 < 3.0 < high


def test_ratios_are_inverse_for_exchanged_figures():
    a, b = np.random.default_rng(1).gamma(2.0, size=(2, 40))
    low, high = Ratio.of(a, b).ci95
    assert Ratio.of(b, a).ci95 == pytest.approx((1 / high, 1 / low))
