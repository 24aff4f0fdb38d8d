"""Verdicts: equal strategies cannot be told apart, and the number of scenarios that is named does tell."""

import re

import numpy as np
import pytest

from train.analysis.verdict import Ranking, unfinished_sentence


def costs(rng, scenarios, **means):
    """Costs (K,) of strategies on the same scenarios, which differ more than the strategies do."""
    common = rng.gamma(4.0, 10.0, size=scenarios)
    return {label: mean * common * rng.gamma(9.0, 1 / 9, size=scenarios) for label, mean in means.items()}


@pytest.mark.long
def test_the_number_of_scenarios_that_would_tell_does_tell_four_times_in_five():
    rng, repeats = np.random.default_rng(3), 200
    ranking = Ranking.of(costs(rng, 20_000, a=1.0, b=1.2, c=2.0))
    needed = ranking.ratio("b", "a").tests[0].needed(np.log(1.2), ranking.tail)
    told = [Ranking.of(costs(rng, needed, a=1.0, b=1.2, c=2.0)).apart("b", "a") for _ in range(repeats)]
    assert 0.7 < np.mean(told) < 0.97  # more than 0.8: by Holm, others that are told leave more room
    fewer = [Ranking.of(costs(rng, needed // 3, a=1.0, b=1.2, c=2.0)).apart("b", "a") for _ in range(repeats)]
    assert np.mean(fewer) < 0.5


@pytest.mark.parametrize("labels", ["ab", pytest.param("abcdefgh", marks=pytest.mark.long)])
def test_equal_strategies_cannot_be_told_apart(labels):
    rng, repeats = np.random.default_rng(5), 200
    wrong = ["cannot be told apart" not in Ranking.of(costs(rng, 30, **dict.fromkeys(labels, 1.0))).sentences()[0]
             for _ in range(repeats)]  # fmt: skip
    assert np.mean(wrong) < 0.1


def test_a_strategy_beside_itself():
    own = np.random.default_rng(6).gamma(4.0, size=12)
    (text,) = Ranking.of({"a": own, "b": own.copy()}).sentences()
    assert text.startswith("a and b cannot be told apart (the same in every scenario); ")


def test_the_best_is_named_with_its_yardstick_and_who_is_no_better_than_chance():
    rng = np.random.default_rng(7)
    found = costs(rng, 60, **{"fixed:ORCA": 1.0, "fixed:Off": 5.0, "Random": 3.0, "policy:x": 3.0})
    ranking = Ranking.of(found, spoken={"fixed:Off": "never avoiding"})
    first, second = ranking.sentences(("fixed:Off", "Random"), ["policy:x"])
    assert re.fullmatch(
        r"ORCA costs least: \d+ s a mission \[\d+, \d+\] \(too narrow: heavy tails\), "
        r"[45]\.\d times less than never avoiding \[.+\]\.",
        first,
    )
    assert second.startswith("policy:x cannot be told from chance (60 scenarios")
    small = Ranking.of(costs(rng, 600, a=1.0, b=1.25)).sentences()
    assert re.search(r"2\d% less than b|1\d% less than b", small[0])


def test_trainings_of_both_sides_count():
    rng = np.random.default_rng(8)
    own = costs(rng, 40, a=1.0, b=1.6)
    seeds = np.array([[0.4], [1.0], [1.6]])
    assert Ranking.of(own).apart("b", "a")
    for one, other in (("a", "b"), ("b", "a")):
        several = Ranking.of({one: own[one] * seeds, other: own[other]})
        assert not several.apart("b", "a")
        assert "more trainings are needed" in several.sentences()[0]


def test_few_scenarios_zeros_and_one_strategy():
    assert "1 scenario cannot tell" in Ranking.of({"a": np.array([3.0]), "b": np.array([9.0])}).sentences()[1]
    assert Ranking.of({"a": np.array([3.0])}).sentences() == ["a costs 3.0 s a mission; nothing is compared with it."]
    zero = Ranking.of({"a": np.zeros(8), "b": np.arange(8.0) + 20.0})
    assert zero.apart("b", "a")
    assert zero.sentences()[0] == "a costs least: 0 s a mission [0, 0], b 24 s."
    assert not Ranking.of({"a": np.zeros(8), "b": np.zeros(8)}).apart("a", "b")
    below = Ranking.of({"a": np.full(8, -1.0), "b": np.arange(8.0)})
    assert all(text for text in below.sentences())


def test_five_scenarios_tell_no_more_than_who_was_better_in_how_many():
    own = np.array([526.8, 377.2, 556.0, 474.2, 408.2]), np.array([140.2, 197.6, 210.4, 90.4, 276.4])
    assert Ranking.of(dict(zip("ab", own, strict=True))).sentences() == [
        "b costs least: 183 s a mission [95, 271], less than a in 5 of 5 scenarios.",
        "5 scenarios cannot tell 2 strategies apart: 6 may; about 230 would tell a tenth.",
    ]
    nine = {label: np.arange(1.0, 10.0) * 2.0**k for k, label in enumerate("abcdef")}
    assert Ranking.of(nine).sentences()[1].startswith("9 scenarios cannot tell 6 strategies apart: 10 may")
    ten = {label: np.arange(1.0, 11.0) * 2.0**k for k, label in enumerate("abcdef")}
    assert Ranking.of(ten).sentences()[0].startswith("a costs least: ")


def test_a_mean_of_times_has_no_interval_below_zero():
    low, high = Ranking.of({"a": np.array([10.0, 90.0])}).means["a"].ci95
    assert low == 0.0
    assert high > 90.0
    assert Ranking.of({"a": np.array([-1.0, 90.0])}).means["a"].ci95[0] < -1.0


def test_who_left_missions_unfinished():
    ranking = Ranking.of({name: np.ones(6) for name in "abcde"})
    none, all_ = np.zeros((1, 6, 1)), np.ones((1, 6, 1))
    two = none.copy()
    two[0, :2] = 1.0
    assert unfinished_sentence({}, ranking) == ""
    assert unfinished_sentence({"a": none, "b": none}, ranking) == "No mission of 12 was left unfinished."
    assert unfinished_sentence({"a": all_}, ranking) == "Every mission of 6 was left unfinished."
    assert unfinished_sentence({"a": none, "b": two}, ranking) == "2 of 12 missions were left unfinished, by b."
    text = unfinished_sentence({"a": two, "b": two, "c": two, "d": all_, "e": none}, ranking)
    assert text == "12 of 30 missions were left unfinished, by d, a, b and c."
