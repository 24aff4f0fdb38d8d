"""What holds for every registered strategy, whoever wrote it."""

import gc
import pickle
import sys
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from clean_swarm_env.testing import check_strategy
from clean_swarm_env.testing.strategies import FEATURES, KEYS, PROBLEM, SHARED_BY
from selector.strategies.bandits.value_table import ValueTable
from selector.strategies.choosing import best
from selector.strategies.problem import Problem
from selector.strategies.registry import STRATEGIES, create
from selector.strategies.streams import row_keys
from selector.strategies.unlearned import MaxScore
from selforg.plugins import PluginError

LUCK = np.random.default_rng(1)
"""Random numbers that no seed decides, for classes that break their promises."""
ROWS = 6

each_sharing = pytest.mark.parametrize("sharing", list(SHARED_BY))
each_strategy = pytest.mark.parametrize("name", STRATEGIES.names())


@each_strategy
def test_a_strategy_keeps_its_contract(name):
    check_strategy(STRATEGIES.find(name))


def broken(monkeypatch, **members):
    """Register a strategy that takes the highest score, but for some of its members."""
    cls = type("Mine", (MaxScore,), {**members, "__module__": __name__})
    monkeypatch.setattr(STRATEGIES, "_classes", dict(STRATEGIES._classes))
    return STRATEGIES.register(cls)


@pytest.mark.parametrize(
    ("select", "said"),
    [
        (lambda self, decisions: np.zeros(3, np.int64), r"Mine._select: expected integers \(320,\), got \(3,\)"),
        (lambda self, decisions: np.full(len(decisions.rows), 7), r"Mine._select: expected options 0\.\.3, got 7\.\.7"),
        (lambda self, decisions: np.ones(len(decisions.rows), int), "Mine._select: option 1 cannot serve row"),
        (lambda self, decisions: decisions.rows % 4, "rows in another order to get the same in that order"),
        (lambda self, decisions: LUCK.integers(0, 4, len(decisions.rows)), "the same for the same seed"),
        (lambda self, decisions: decisions.context.fill(0), "ValueError: assignment destination is read-only"),
        (lambda self, decisions: self.luck, "AttributeError: 'Mine' object has no attribute 'luck'"),
        (lambda self, decisions: sys.exit(0), "SystemExit: 0"),
        (lambda self, decisions: self.chance.fill(np.nan) or best(self._opinions(decisions), decisions.allowed),
         "Mine.select: expected chances above 0 and up to 1"),
    ],
)  # fmt: skip
def test_a_strategy_that_breaks_its_contract_is_one_line(select, said, monkeypatch):
    with pytest.raises(ValueError, match=said) as raised:
        check_strategy(broken(monkeypatch, _select=select))
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ({"_first_state": lambda self: {"many": np.zeros((self.groups + 1, 2))}}, "Mine.__init__: expected a state"),
        ({"_first_state": lambda self: {"nan": np.full((self.groups, 2), np.nan)}}, "Mine.__init__: expected a state"),
        ({"_first_state": lambda self: None}, "TypeError: 'NoneType' object is not iterable"),
        ({"_prepare": lambda self: sys.exit(0)}, "SystemExit: 0"),
        ({"_first_state": lambda self: {"many": np.zeros((self.groups, 2))},
          "_update": lambda self, outcomes: self.many.fill(np.inf)}, "Mine.update: expected a state of finite"),
    ],
)  # fmt: skip
def test_a_strategy_whose_learned_arrays_are_wrong_is_one_line(members, said, monkeypatch):
    with pytest.raises(PluginError, match=said):
        check_strategy(broken(monkeypatch, **members))


@pytest.mark.parametrize(
    ("think", "said"),
    [
        (lambda self, decisions: np.zeros(77), "ValueError: could not broadcast"),
        (lambda self, decisions: np.nan, "Mine.opinions: expected opinions that are numbers"),
        (lambda self, decisions: sys.exit(0), "SystemExit: 0"),
    ],
)
def test_a_strategy_whose_opinions_are_wrong_is_one_line(think, said, monkeypatch):
    strategy = broken(monkeypatch, _opinions=think)(PROBLEM, KEYS[:2])
    with pytest.raises(PluginError, match=said):
        strategy.opinions(np.zeros((2, FEATURES)))


def test_a_strategy_whose_state_is_wrong_is_one_line(monkeypatch):
    lucky = {
        "_prepare": lambda self: setattr(self, "seen", 0),
        "_select": lambda self, d: (setattr(self, "seen", self.seen + 1), np.full(len(d.rows), self.seen % 3))[1],
    }
    with pytest.raises(PluginError, match="expected to go on from what was learned exactly, got others"):
        check_strategy(broken(monkeypatch, **lucky))


@pytest.fixture
def fresh(name, sharing):
    def make(problem=PROBLEM, keys=KEYS[:ROWS], groups=None):
        parameters = STRATEGIES.find(name).example(problem)
        groups = SHARED_BY[sharing][: len(keys)] if groups is None else groups
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


def whole_state(strategy):
    """Return copies of what a strategy has learned, and of what its random draws depend on."""
    return {**strategy.learned(), **{name: getattr(strategy, name).copy() for name in ("keys", "counters", "chance")}}


def same(first, second):
    assert first.keys() == second.keys()
    for key, value in first.items():
        np.testing.assert_array_equal(second[key], value, err_msg=key)


@each_strategy
@each_sharing
def test_rows_that_do_not_decide_are_as_if_they_were_not_there(fresh, sharing):
    some, few = np.array([4, 1]), fresh(groups=np.arange(ROWS) if sharing == "robot" else np.zeros(ROWS, int))
    only = fresh(keys=KEYS[some], groups=np.arange(2) if sharing == "robot" else np.zeros(2, int))
    for context in contexts():
        chosen = few.select(context[some], rows=some)
        np.testing.assert_array_equal(chosen, only.select(context[some]))
        reward = (chosen == 2) + context[some][:, 1]
        few.update(chosen, reward, context[some], rows=some)
        only.update(chosen, reward, context[some])


@each_strategy
@each_sharing
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


@each_strategy
@each_sharing
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


@each_strategy
@each_sharing
def test_what_was_saved_does_not_move_with_the_strategy(fresh):
    strategy = fresh()
    state = strategy.learned()
    before = {key: value.copy() for key, value in state.items()}
    live(strategy, contexts())
    same(before, state)


@each_strategy
@each_sharing
def test_reseeding_with_what_a_new_one_knows_begins_anew(fresh):
    strategy, new = fresh(), fresh(keys=KEYS[100 : 100 + ROWS])
    live(strategy, contexts())
    strategy.reseed(np.arange(ROWS), KEYS[100 : 100 + ROWS])
    strategy.load_learned(new.learned())
    same(strategy.learned(), new.learned())
    np.testing.assert_array_equal(live(strategy, contexts()), live(new, contexts()))


@each_strategy
@each_sharing
def test_one_option_is_always_taken(fresh):
    problem = Problem("Goal", ("a",), np.array([-3.0]), PROBLEM.features)
    assert (live(fresh(problem), contexts()) == 0).all()


@each_strategy
@each_sharing
def test_no_rows_no_decisions(fresh):
    strategy, nothing = fresh(), np.zeros(0, int)
    before = whole_state(strategy)
    assert strategy.select(np.zeros((0, FEATURES)), rows=nothing).shape == (0,)
    strategy.update(nothing, np.zeros(0), np.zeros((0, FEATURES)), nothing)
    same(before, whole_state(strategy))


REWARDS = np.array([[4, 0, 1, 9], [1.0, 7.0, -1.0, 0.5], [0.25, 3.0, 0.0, 1.0]])  # count, mean, variance


@each_strategy
@each_sharing
def test_what_a_store_knows_is_where_a_strategy_begins(fresh):
    strategy, other = fresh(replace(PROBLEM, rewards=REWARDS)), fresh()
    if not isinstance(strategy, ValueTable):  # the scores that count are then all it knows
        told = fresh(replace(PROBLEM, scores=strategy.problem.scores))
        same(strategy.learned(), told.learned())
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
        (lambda s: s.load_learned({"wisdom": np.zeros(3)}), r"state: expected the arrays .*, got \['wisdom'\]"),
    ],
)
@each_strategy
@each_sharing
def test_what_does_not_fit_is_refused(fresh, use, message):
    strategy = fresh()
    before = whole_state(strategy)
    with pytest.raises(ValueError, match=message):
        use(strategy)
    same(before, whole_state(strategy))


@pytest.mark.parametrize("way", [deepcopy, lambda strategy: pickle.loads(pickle.dumps(strategy))])
@each_strategy
@each_sharing
def test_a_copy_learns_on_by_itself_and_decides_as_the_original(fresh, way):
    strategy = fresh()
    live(strategy, contexts(4))
    twin, orphan = way(strategy), way(strategy)
    course = live(twin, contexts(12))
    np.testing.assert_array_equal(live(strategy, contexts(12)), course)
    del strategy, twin
    gc.collect()
    np.testing.assert_array_equal(live(orphan, contexts(12)), course)
