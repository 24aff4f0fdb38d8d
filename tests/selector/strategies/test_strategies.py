import doctest
import re

import numpy as np
import pytest

import selector.strategies.registry
import selector.strategies.strategy
from selector.documents.errors import DocumentError
from selector.strategies.bandits import exp3, linear, upper_confidence
from selector.strategies.problem import Problem
from selector.strategies.registry import STRATEGIES, StrategySpec, spec_from_text
from selector.strategies.unlearned import Fixed, MaxScore, Random
from tests.selector.refusing import refusal

NO_CONTEXT = np.zeros((3, 0))
KEYS = np.arange(3, dtype=np.uint64)


def problem(scores):
    return Problem("Goal", tuple("abcd"[: len(scores)]), np.array(scores))


@pytest.mark.parametrize(
    ("scores", "best"), [([1.0, 1.0, 0.9], 0), ([-5.0, -4.0, -4.0], 1), ([0.0], 0), ([1, 2, 2.0], 1)]
)
def test_max_score_takes_the_first_of_the_highest(scores, best):
    strategy = MaxScore(problem(scores), KEYS)
    strategy.update(np.array([2, 0, 1]) % len(scores), np.full(3, 100.0), NO_CONTEXT)
    assert strategy.select(NO_CONTEXT).tolist() == [best] * 3


def test_max_score_takes_the_best_that_can_serve():
    allowed = np.array([[True, False, True], [False, True, True], [True, False, False]])
    assert MaxScore(problem([1.0, 3.0, 2.0]), KEYS).select(NO_CONTEXT, allowed).tolist() == [2, 1, 0]


def test_a_fixed_option_is_taken_wherever_it_can_serve():
    strategy = Fixed(problem([1.0, 3.0, 2.0]), KEYS, {"option": "a"})
    assert strategy.select(NO_CONTEXT).tolist() == [0, 0, 0]
    allowed = np.array([[False, True, True], [True, True, True], [False, False, True]])
    assert strategy.select(NO_CONTEXT, allowed).tolist() == [1, 0, 2]


def test_a_fixed_option_has_to_exist():
    with pytest.raises(DocumentError, match=r"strategy Fixed: goal Goal: unknown option 'd' \(known: a, b, c"):
        Fixed(problem([1.0, 3.0, 2.0]), KEYS, {"option": "d"})
    with pytest.raises(DocumentError, match="strategy Fixed: option: missing key"):
        Fixed(problem([1.0, 3.0, 2.0]), KEYS)


def test_random_options_are_equally_frequent_among_those_that_can_serve():
    rows = 6000
    strategy = Random(problem([9.0, 0.0, 0.0, 0.0]), np.arange(rows, dtype=np.uint64))
    allowed = np.tile([True, True, False, True], (rows, 1))
    counts = np.bincount(strategy.select(np.zeros((rows, 0)), allowed), minlength=4)
    assert counts[2] == 0
    np.testing.assert_allclose(counts[[0, 1, 3]], rows / 3, atol=5 * np.sqrt(rows * 2 / 9))  # five standard deviations
    np.testing.assert_allclose(strategy.chance, 1 / 3)


@pytest.mark.parametrize(
    ("text", "spec"),
    [
        ("MaxScore", StrategySpec(name="MaxScore")),
        ("Fixed:option=b", StrategySpec(name="Fixed", parameters={"option": "b"})),
        (
            "DiscountedUCB:discount=0.9,prior=1e-3,sharing=robot",
            StrategySpec(name="DiscountedUCB", parameters={"discount": 0.9, "prior": 0.001}, sharing="robot"),
        ),
    ],
)
def test_a_strategy_is_named_in_one_word(text, spec):
    assert spec_from_text(text) == spec


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Luck", "unknown strategy 'Luck'"),
        ("UCB1:prior", "expected NAME:parameter=value,.*got 'prior'"),
        ("UCB1:prior=1,prior=2", "each once, got 'prior=2'"),
        ("UCB1:prior=-1", r"strategy 'UCB1:prior=-1': UCB1: prior: expected greater than or equal to 0, got -1"),
        ("UCB1:prior={", "expected a value, got '{'"),
        ("UCB1:sharing=nobody", "sharing: expected 'all', 'team' or 'robot', got 'nobody'"),
        ("EXP3:lowest=2", "EXP3: highest: expected more than the lowest reward 2"),
        ("", "name: "),
    ],
)
def test_what_names_no_strategy_is_one_line(text, message):
    assert re.search(message, refusal(spec_from_text, text))


def test_sharing_says_who_learns_together():
    teams = np.array([0, 0, 1, 1, 1])
    for sharing, groups in (("all", [0] * 5), ("team", [0, 0, 1, 1, 1]), ("robot", [0, 1, 2, 3, 4])):
        spec = StrategySpec(name="UCB1", sharing=sharing)
        strategy = spec.build(problem([1.0, 2.0]), np.arange(5, dtype=np.uint64), teams)
        assert strategy.group_of.tolist() == groups
        assert strategy.learned()["counts"].shape == (max(groups) + 1, 2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("Goal", (), []), "at least one option"),
        (("Goal", ("a",), [[1.0]]), r"scores: expected shape \(1,\), got \(1, 1\)"),
        (("Goal", ("a", "b"), [np.nan, 1.0]), "scores: expected finite"),
        (("Goal", ("a", "a"), [0.0, 1.0]), "option 'a' is given twice"),
        (("Goal", ("a",), [0.0], ("x", "x")), "feature 'x' is given twice"),
    ],
)
def test_problems_that_make_no_sense_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Problem(arguments[0], arguments[1], np.array(arguments[2]), *arguments[3:])


@pytest.mark.parametrize(
    "module", [selector.strategies.strategy, selector.strategies.registry, exp3, linear, upper_confidence]
)
def test_the_examples_in_the_texts_work(module, monkeypatch):
    monkeypatch.setattr(STRATEGIES, "_classes", {cls.__name__: cls for cls in STRATEGIES})
    failed, attempted = doctest.testmod(module)
    assert attempted > 0
    assert failed == 0
