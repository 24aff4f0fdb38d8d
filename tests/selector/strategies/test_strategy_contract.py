"""What holds for every registered strategy, whoever wrote it."""

import gc
import pickle
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from selector.strategies.bandits.value_table import ValueTable
from selector.strategies.problem import Problem
from selector.strategies.registry import STRATEGIES, create
from selector.strategies.streams import row_keys

ROWS, FEATURES = 6, 3
SCORES = np.array([0.2, 1.0, -0.5, 1.0])
PROBLEM = Problem("Goal", ("a", "b", "c", "d"), SCORES, ("x", "y", "z"))
KEYS = row_keys(np.random.SeedSequence(7), 320)
GROUPS = {
    "all": lambda rows: np.zeros(rows, int),
    "team": lambda rows: np.arange(rows) // 3,
    "robot": np.arange,
}

pytestmark = [
    pytest.mark.parametrize("name", STRATEGIES.names()),
    pytest.mark.parametrize("sharing", list(GROUPS)),
]


@pytest.fixture
def fresh(name, sharing):
    def make(problem=PROBLEM, keys=KEYS[:ROWS], groups=None):
        parameters = STRATEGIES.find(name).example(problem)
        groups = GROUPS[sharing](len(keys)) if groups is None else groups
        return create(name, problem, keys, parameters, groups=groups)

    return make


def contexts(steps=8, rows=ROWS):
    return np.random.default_rng(1).normal(size=(steps, rows, FEATURES))


def live(strategy, steps, order=slice(None)):
    """Let the strategy decide and learn; the reward prefers option 2. Returns the options (steps, R)."""
    chosen = []
    for context in steps:
        options = strategy.select(context[order])
        strategy.update(options, (options == 2) + 0.1 * context[order][:, 0], context[order])
        chosen.append(options)
    return np.array(chosen)


def same(first, second):
    assert first.keys() == second.keys()
    for key, value in first.items():
        np.testing.assert_array_equal(second[key], value, err_msg=key)


def test_options_have_the_right_shape_and_range(fresh):
    chosen = live(fresh(), contexts())
    assert chosen.shape == (8, ROWS)
    assert chosen.dtype == np.int64
    assert chosen.min() >= 0
    assert chosen.max() < len(SCORES)


def test_same_seed_same_decisions(fresh):
    first, second = fresh(), fresh()
    np.testing.assert_array_equal(live(first, contexts()), live(second, contexts()))
    same(first.state_dict(), second.state_dict())


def test_a_permutation_of_rows_permutes_decisions_and_nothing_else(fresh, sharing):
    order = np.random.default_rng(3).permutation(300)
    steps, groups = contexts(5, 300), GROUPS[sharing](300)
    straight, permuted = fresh(keys=KEYS[:300]), fresh(keys=KEYS[:300][order], groups=groups[order])
    np.testing.assert_array_equal(live(permuted, steps, order), live(straight, steps)[:, order])
    same(straight.learned(), permuted.learned())  # bit for bit, whatever the order of the sums


def test_a_row_that_learns_for_itself_decides_alike_alone(fresh, sharing):
    if sharing != "robot":
        pytest.skip("rows that share estimates learn from each other")
    steps = contexts(12, 320)
    many = fresh(keys=KEYS)
    together, state = live(many, steps), many.state_dict()
    for row in (0, 1, 7, 100, 319):
        alone = fresh(keys=KEYS[row : row + 1])
        np.testing.assert_array_equal(live(alone, steps, slice(row, row + 1))[:, 0], together[:, row])
        same({key: value[row : row + 1] for key, value in state.items()}, alone.state_dict())


def test_a_team_decides_alike_alone(fresh, sharing):
    if sharing != "team":
        pytest.skip("only teams are alone with themselves")
    steps = contexts(12, 9)
    together = live(fresh(keys=KEYS[:9]), steps)
    alone = live(fresh(keys=KEYS[3:6]), steps, slice(3, 6))
    np.testing.assert_array_equal(alone, together[:, 3:6])


def test_rows_that_do_not_decide_are_as_if_they_were_not_there(fresh, sharing):
    some, few = np.array([4, 1]), fresh(groups=np.arange(ROWS) if sharing == "robot" else np.zeros(ROWS, int))
    only = fresh(keys=KEYS[some], groups=np.arange(2) if sharing == "robot" else np.zeros(2, int))
    for context in contexts():
        chosen = few.select(context[some], rows=some)
        np.testing.assert_array_equal(chosen, only.select(context[some]))
        reward = (chosen == 2) + context[some][:, 1]
        few.update(chosen, reward, context[some], rows=some)
        only.update(chosen, reward, context[some])


def test_options_that_cannot_serve_are_never_taken(fresh):
    generator, strategy = np.random.default_rng(5), fresh(keys=KEYS)
    for context in contexts(20, 320):
        allowed = generator.random((320, 4)) < 0.4
        allowed[np.arange(320), generator.integers(4, size=320)] = True
        chosen = strategy.select(context, allowed)
        assert allowed[np.arange(320), chosen].all()
        strategy.update(chosen, generator.normal(size=320), context)


def test_the_chance_of_a_choice_is_how_often_it_is_made(fresh):
    rows = 4000
    strategy = fresh(keys=row_keys(np.random.SeedSequence(5), rows), groups=np.zeros(rows, int))
    live(strategy, contexts(1, rows))
    context = np.zeros((rows, FEATURES))
    chosen = strategy.select(context)
    if strategy.draws_per_decision != 1 and type(strategy).__name__ != "EpsilonGreedy":
        assert (strategy.chance == 1.0).all()  # nothing is said
        return
    for option in np.unique(chosen):
        (stated,) = np.unique(strategy.chance[chosen == option])
        # five standard deviations: a false alarm in a million
        assert abs((chosen == option).mean() - stated) < 5 * np.sqrt(stated * (1 - stated) / rows) + 1e-12


def test_inputs_are_left_alone_and_not_kept(fresh):
    strategy = fresh()
    context = contexts()[0]
    options, reward = np.arange(ROWS) % len(SCORES), np.linspace(-1, 1, ROWS)
    allowed = np.ones((ROWS, 4), dtype=bool)
    before = [array.copy() for array in (context, options, reward, allowed)]
    strategy.select(context, allowed)
    strategy.update(options, reward, context)
    for array, kept in zip((context, options, reward, allowed), before, strict=True):
        np.testing.assert_array_equal(array, kept)
        assert array.flags.writeable
    state = strategy.state_dict()
    for array in (context, options, reward, allowed):
        array[...] = 0
    same(strategy.state_dict(), state)


def test_late_rewards_of_several_decisions_come_together(fresh):
    strategy, steps = fresh(), contexts(3)
    pending = []
    for context in steps:
        option = strategy.select(context)
        pending.append((np.arange(ROWS), option, context, strategy.chance.copy()))
    rows, option, context, chance = (np.concatenate(parts) for parts in zip(*pending, strict=True))
    reward = np.random.default_rng(2).normal(size=len(rows))
    other = fresh()
    strategy.update(option, reward, context, rows, chance)
    mixed = np.random.default_rng(4).permutation(len(rows))
    other.update(option[mixed], reward[mixed], context[mixed], rows[mixed], chance[mixed])
    same(strategy.learned(), other.learned())


def test_what_was_learned_begins_with_the_groups(fresh):
    strategy = fresh()
    for array in strategy.learned().values():
        assert isinstance(array, np.ndarray)
        assert array.dtype != object
        assert array.shape[0] == strategy.groups


def test_state_is_data_and_a_strategy_goes_on_from_it_exactly(fresh):
    first, second = fresh(), fresh(keys=KEYS[ROWS : 2 * ROWS])
    live(first, contexts())
    second.load_state(first.state_dict())
    later = contexts()[::-1]
    np.testing.assert_array_equal(live(first, later), live(second, later))
    same(first.state_dict(), second.state_dict())


def test_what_one_group_learned_is_given_to_many(fresh):
    teacher = fresh(groups=np.zeros(ROWS, int))
    live(teacher, contexts())
    learner = fresh(keys=KEYS[:9], groups=np.arange(9))
    learner.load_learned(teacher.learned())
    for key, value in learner.learned().items():
        assert value.shape[0] == 9
        np.testing.assert_array_equal(value, np.broadcast_to(teacher.learned()[key], value.shape))


def test_saved_state_does_not_move_with_the_strategy(fresh):
    strategy = fresh()
    state = strategy.state_dict()
    before = {key: value.copy() for key, value in state.items()}
    live(strategy, contexts())
    same(before, state)


def test_reseeding_with_what_a_new_one_knows_begins_anew(fresh):
    strategy, new = fresh(), fresh(keys=KEYS[100 : 100 + ROWS])
    live(strategy, contexts())
    strategy.reseed(np.arange(ROWS), KEYS[100 : 100 + ROWS])
    strategy.load_learned(new.learned())
    same(strategy.state_dict(), new.state_dict())
    np.testing.assert_array_equal(live(strategy, contexts()), live(new, contexts()))


def test_one_option_is_always_taken(fresh):
    problem = Problem("Goal", ("a",), np.array([-3.0]), PROBLEM.features)
    assert (live(fresh(problem), contexts()) == 0).all()


def test_no_rows_no_decisions(fresh):
    strategy, nothing = fresh(), np.zeros(0, int)
    before = strategy.state_dict()
    assert strategy.select(np.zeros((0, FEATURES)), rows=nothing).shape == (0,)
    strategy.update(nothing, np.zeros(0), np.zeros((0, FEATURES)), nothing)
    same(before, strategy.state_dict())


REWARDS = np.array([[4, 0, 1, 9], [1.0, 7.0, -1.0, 0.5], [0.25, 3.0, 0.0, 1.0]])  # count, mean, variance


def test_what_a_store_knows_is_where_a_strategy_begins(fresh):
    strategy, other = fresh(replace(PROBLEM, rewards=REWARDS)), fresh()
    if not isinstance(strategy, ValueTable):  # the scores that count are then all it knows
        told = fresh(replace(PROBLEM, scores=strategy.problem.scores))
        same(strategy.state_dict(), told.state_dict())
        return
    for group in range(other.groups):
        rows = np.flatnonzero(other.group_of == group)[:1].repeat(14)
        option = np.repeat([0, 2, 3], [4, 1, 9])
        reward = np.array([0.5, 1.5, 0.5, 1.5, -1.0, *(0.5 + np.array([-1, -1, 0, 0, 0, 0, 0, 1, 1]) * 1.5)])
        other.update(option, reward, np.zeros((14, FEATURES)), rows)
    for key, value in strategy.learned().items():
        np.testing.assert_allclose(value, other.learned()[key], atol=1e-12)


ALL = np.ones((ROWS, 4), dtype=bool)
NONE = np.zeros((ROWS, FEATURES))


@pytest.mark.parametrize(
    ("use", "message"),
    [
        (lambda s: s.select(np.zeros((ROWS, FEATURES + 1))), r"context: expected shape \(6, 3\), got \(6, 4\)"),
        (lambda s: s.select(np.full((ROWS, FEATURES), np.nan)), "context: expected finite numbers, got nan"),
        (lambda s: s.select(NONE, ALL[:, :3]), r"allowed: expected truth values \(6, 4\), got \(6, 3\) of bool"),
        (lambda s: s.select(NONE, ALL & (np.arange(ROWS) != 2)[:, None]), "allowed: .* got none for 2"),
        (lambda s: s.select(NONE[:2], rows=np.array([3, 3])), "rows: expected each row once"),
        (lambda s: s.select(NONE[:1], rows=np.array([6])), r"rows: expected rows 0\.\.5, got 6\.\.6"),
        (
            lambda s: s.update(np.full(ROWS, 4), np.zeros(ROWS), NONE),
            r"option: expected options 0\.\.3, got 4\.\.4",
        ),
        (
            lambda s: s.update(np.zeros(ROWS), np.zeros(ROWS), NONE),
            r"option: expected integers \(6,\), got \(6,\) of float64",
        ),
        (
            lambda s: s.update(np.zeros(ROWS, int), np.full(ROWS, np.inf), NONE),
            "reward: expected finite numbers, got inf",
        ),
        (
            lambda s: s.update(np.zeros(ROWS, int), np.zeros(ROWS), NONE, chance=np.zeros(ROWS)),
            "chance: expected probabilities above 0",
        ),
        (lambda s: s.load_state({}), "state: expected the arrays .*counters.*, got"),
        (lambda s: s.load_state(s.state_dict() | {"keys": np.zeros(99)}), "state 'keys': expected .* got"),
        (lambda s: s.load_learned({"wisdom": np.zeros(3)}), r"state: expected the arrays .*, got \['wisdom'\]"),
    ],
)
def test_what_does_not_fit_is_refused(fresh, use, message):
    strategy = fresh()
    before = strategy.state_dict()
    with pytest.raises(ValueError, match=message):
        use(strategy)
    same(before, strategy.state_dict())


@pytest.mark.parametrize("way", [deepcopy, lambda strategy: pickle.loads(pickle.dumps(strategy))])
def test_a_copy_learns_on_by_itself_and_decides_as_the_original(fresh, way):
    strategy = fresh()
    live(strategy, contexts(4))
    twin, orphan = way(strategy), way(strategy)
    course = live(twin, contexts(12))
    np.testing.assert_array_equal(live(strategy, contexts(12)), course)
    del strategy, twin
    gc.collect()
    np.testing.assert_array_equal(live(orphan, contexts(12)), course)
