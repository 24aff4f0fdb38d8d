"""What holds for every registered strategy, whoever wrote it."""

import numpy as np
import pytest

import selector.strategies  # noqa: F401  (registers the strategies that ship)
from selector.strategy import create, registered

ROWS, FEATURES = 6, 3
SCORES = np.array([0.2, 1.0, -0.5, 1.0])

pytestmark = [
    pytest.mark.parametrize("name", list(registered())),
    pytest.mark.parametrize("shared", [True, False], ids=["shared", "own"]),
]


def generators(seed=7, order=range(ROWS)):
    children = np.random.SeedSequence(seed).spawn(ROWS)
    return [np.random.default_rng(children[row]) for row in order]


def contexts(steps=8, rows=ROWS):
    return np.random.default_rng(1).normal(size=(steps, rows, FEATURES))


def fresh(name, shared, **changes):
    arguments = {"scores": SCORES, "generators": generators(), "features": FEATURES, "shared": shared} | changes
    return create(name, **arguments)


def live(strategy, steps, order=slice(None)):
    """Let the strategy decide and learn; the reward prefers option 2. Returns the options (steps, R)."""
    chosen = []
    for context in steps:
        options = strategy.select(context[order])
        strategy.update(options, (options == 2) + 0.1 * context[order][:, 0], context[order])
        chosen.append(options)
    return np.array(chosen)


def test_options_have_the_right_shape_and_range(name, shared):
    chosen = live(fresh(name, shared), contexts())
    assert chosen.shape == (8, ROWS)
    assert chosen.dtype == np.int64
    assert chosen.min() >= 0
    assert chosen.max() < len(SCORES)


def test_same_seed_same_decisions(name, shared):
    np.testing.assert_array_equal(live(fresh(name, shared), contexts()), live(fresh(name, shared), contexts()))


def test_a_permutation_of_rows_permutes_decisions(name, shared):
    order = np.array([3, 0, 5, 1, 4, 2])
    straight = live(fresh(name, shared), contexts())
    permuted = live(fresh(name, shared, generators=generators(order=order)), contexts(), order)
    np.testing.assert_array_equal(permuted, straight[:, order])


def test_a_row_that_learns_for_itself_decides_alike_alone(name, shared):
    if shared:
        pytest.skip("rows that share estimates learn from each other")
    together = live(fresh(name, shared), contexts())
    for row in range(ROWS):
        alone = fresh(name, shared, generators=[generators()[row]])
        np.testing.assert_array_equal(live(alone, contexts(), slice(row, row + 1))[:, 0], together[:, row])


def test_inputs_are_left_alone_and_not_kept(name, shared):
    strategy, scores = fresh(name, shared), SCORES.copy()
    context = contexts()[0]
    options, reward = np.arange(ROWS) % len(SCORES), np.linspace(-1, 1, ROWS)
    before = [array.copy() for array in (context, options, reward)]
    strategy.select(context)
    strategy.update(options, reward, context)
    for array, copy in zip((context, options, reward), before, strict=True):
        np.testing.assert_array_equal(array, copy)
        assert array.flags.writeable
    state = strategy.state_dict()
    for array in (context, options, reward):
        array[...] = 0
    for key, value in strategy.state_dict().items():
        np.testing.assert_array_equal(value, state[key])
    np.testing.assert_array_equal(scores, SCORES)


def test_state_is_data_and_can_be_moved_to_another_strategy(name, shared):
    first = fresh(name, shared)
    live(first, contexts())
    state = first.state_dict()
    assert all(isinstance(value, np.ndarray) and value.dtype != object for value in state.values())
    rows = 1 if shared else ROWS
    assert state["estimates"].shape == (rows, len(SCORES))
    second = fresh(name, shared)
    second.load_state(state)
    third = fresh(name, shared)
    third.load_state(state)
    later = contexts()[::-1]
    np.testing.assert_array_equal(live(second, later), live(third, later))
    # What was loaded is a copy: learning further must not change what was saved.
    for key, value in fresh(name, shared).state_dict().items():
        assert value.shape == state[key].shape


def test_saved_state_does_not_move_with_the_strategy(name, shared):
    strategy = fresh(name, shared)
    state = strategy.state_dict()
    before = {key: value.copy() for key, value in state.items()}
    live(strategy, contexts())
    for key, value in before.items():
        np.testing.assert_array_equal(state[key], value)


def test_one_option_is_always_taken(name, shared):
    strategy = fresh(name, shared, scores=np.array([-3.0]))
    assert (live(strategy, contexts()) == 0).all()


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda s: s.select(np.zeros((ROWS, FEATURES + 1))), r"context: expected shape \(6, 3\), got \(6, 4\)"),
        (lambda s: s.select(np.full((ROWS, FEATURES), np.nan)), "context: expected finite numbers, got nan"),
        (
            lambda s: s.update(np.full(ROWS, 4), np.zeros(ROWS), np.zeros((ROWS, FEATURES))),
            r"option: expected options 0\.\.3, got 4\.\.4",
        ),
        (
            lambda s: s.update(np.zeros(ROWS), np.zeros(ROWS), np.zeros((ROWS, FEATURES))),
            r"option: expected integers \(6,\), got \(6,\) of float64",
        ),
        (
            lambda s: s.update(np.zeros(ROWS, int), np.full(ROWS, np.inf), np.zeros((ROWS, FEATURES))),
            "reward: expected finite numbers, got inf",
        ),
        (lambda s: s.load_state({}), "state: expected the arrays .*estimates.*, got"),
        (
            lambda s: s.load_state(s.state_dict() | {"estimates": np.zeros((2, 9))}),
            "state 'estimates': expected .* got",
        ),
    ],
)
def test_what_does_not_fit_is_refused(name, shared, use, message):
    strategy = fresh(name, shared)
    before = strategy.state_dict()
    with pytest.raises(ValueError, match=message):
        use(strategy)
    for key, value in strategy.state_dict().items():
        np.testing.assert_array_equal(value, before[key])
