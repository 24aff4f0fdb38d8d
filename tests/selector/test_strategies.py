import numpy as np
import pytest

import selector.strategies  # noqa: F401  (registers the strategies that ship)
from selector.strategies.max_score import MaxScore
from selector.strategy import DecisionStrategy, create, register


def rows(count):
    return [np.random.default_rng(row) for row in range(count)]


@pytest.mark.parametrize(
    ("scores", "best"), [([1.0, 1.0, 0.9], 0), ([-5.0, -4.0, -4.0], 1), ([0.0], 0), ([1, 2, 2.0], 1)]
)
def test_max_score_takes_the_first_of_the_highest(scores, best):
    strategy = MaxScore(np.array(scores), rows(3))
    strategy.update(np.array([2, 0, 1]) % len(scores), np.full(3, 100.0), np.zeros((3, 0)))
    assert strategy.select(np.zeros((3, 0))).tolist() == [best] * 3


def test_max_score_follows_estimates_that_a_row_holds_for_itself():
    strategy = MaxScore(np.array([1.0, 0.0]), rows(2), shared=False)
    strategy.load_state({"estimates": np.array([[0.0, 1.0], [1.0, 0.0]])})
    assert strategy.select(np.zeros((2, 0))).tolist() == [1, 0]


def test_unknown_and_double_names_are_refused():
    with pytest.raises(ValueError, match=r"unknown strategy 'Best' \(known: .*MaxScore"):
        create("Best", np.ones(2), rows(1))
    with pytest.raises(ValueError, match="'MaxScore' is registered twice"):
        register(MaxScore)


@pytest.mark.parametrize(
    ("scores", "message"),
    [([], "at least one option, got"), ([[1.0]], r"shape \(O,\)"), ([np.nan, 1.0], "scores: expected finite")],
)
def test_scores_that_cannot_be_compared_are_refused(scores, message):
    with pytest.raises(ValueError, match=message):
        MaxScore(np.array(scores), rows(1))


class Gambler(DecisionStrategy):
    """Takes any option and remembers how often: what a random, learning strategy needs of the blueprint."""

    draws_per_decision = 1
    state_names = ("estimates", "counts")

    def __init__(self, scores, generators, **settings):
        super().__init__(scores, generators, **settings)
        self.counts = np.zeros(self.estimates.shape, dtype=np.int64)

    def _select(self, context, draws):
        return (draws[:, 0] * self.options).astype(np.int64)

    def _update(self, option, reward, context):
        np.add.at(self.counts, (np.zeros_like(option) if self.shared else np.arange(self.rows), option), 1)


def test_rows_draw_from_their_own_generators():
    together = Gambler(np.zeros(50), rows(4))
    alone = [Gambler(np.zeros(50), [np.random.default_rng(row)]) for row in range(4)]
    for _ in range(5):
        chosen = together.select(np.zeros((4, 0)))
        assert chosen.tolist() == [one.select(np.zeros((1, 0)))[0] for one in alone]
        assert len(set(chosen.tolist())) > 1


def test_further_state_is_saved_and_loaded_by_name():
    first, second = (Gambler(np.zeros(3), rows(2), shared=False) for _ in range(2))
    first.update(np.array([1, 2]), np.zeros(2), np.zeros((2, 0)))
    assert first.state_dict()["counts"].tolist() == [[0, 1, 0], [0, 0, 1]]
    second.load_state(first.state_dict())
    first.update(np.array([1, 2]), np.zeros(2), np.zeros((2, 0)))
    assert second.counts.tolist() == [[0, 1, 0], [0, 0, 1]]
    with pytest.raises(ValueError, match=r"'counts': expected .* of int64, got .* of float64"):
        second.load_state(first.state_dict() | {"counts": np.zeros((2, 3))})


def test_an_option_that_does_not_exist_is_the_strategys_error():
    class Wild(Gambler):
        def _select(self, context, draws):
            return np.full(self.rows, 7)

    with pytest.raises(ValueError, match=r"Wild\._select: expected options 0\.\.2, got 7"):
        Wild(np.zeros(3), rows(2)).select(np.zeros((2, 0)))
