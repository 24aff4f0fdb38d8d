"""The contract of decision strategies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from clean_swarm_env.testing.expecting import expect, expect_registered, expect_same
from selector.strategies.problem import Problem
from selector.strategies.registry import STRATEGIES, create
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import row_keys
from selforg.arrays import Floats, Ints
from selforg.plugins import contract

TEAMS_ROWS, FEATURES = 320, 3
PROBLEM = Problem("Goal", ("a", "b", "c", "d"), np.array([0.2, 1.0, -0.5, 1.0]), ("x", "y", "z"))
KEYS = row_keys(np.random.SeedSequence(7), TEAMS_ROWS)
EVERY = np.arange(TEAMS_ROWS)
SHARED_BY: dict[str, Ints] = {"all": EVERY * 0, "team": EVERY // 3, "robot": EVERY}
"""How rows share estimates -> the group of each row."""


def check_strategy(cls: type[DecisionStrategy], **parameters: Any) -> None:  # noqa: ANN401  (those of the class)
    """Raise PluginError, one line, unless a registered strategy keeps its contract.

    With estimates that all, teams or single rows share, it takes options that can serve, the same for the same seed,
    for rows in any order, and for a robot or a team alone; inputs are neither changed nor kept; learned arrays begin
    with the groups, and it goes on from what was learned exactly. `parameters`: beside those of `example`.
    """
    expect_registered(cls, STRATEGIES)
    for sharing, groups in SHARED_BY.items():
        check_shared(lambda rows, own: fresh(cls, own, rows, parameters), cls, sharing, groups)


def fresh(cls: type[DecisionStrategy], groups: Ints, rows: Ints, parameters: Any) -> DecisionStrategy:  # noqa: ANN401
    """Return a strategy of `rows` (K,) in `groups` (K,) that has decided nothing."""
    with contract(cls, "__init__"):
        return create(cls.__name__, PROBLEM, KEYS[rows], {**cls.example(PROBLEM), **parameters}, groups=groups)


def live(strategy: DecisionStrategy, steps: Floats, allowed: Any = None) -> Ints:  # noqa: ANN401
    """Let a strategy decide and learn in contexts (T, R, F); option 2 is rewarded. Return the options (T, R)."""
    chosen = []
    for context in steps:
        seen = context.copy()
        options = strategy.select(seen, allowed)
        chosen.append(options.copy())
        reward = (options == 2) + 0.1 * seen[:, 0]
        with contract(strategy, "_update", options, reward, seen):
            strategy.update(options, reward, seen)
        learned = list(strategy.learned().values())
        for array in (options, reward, seen):
            array[...] = 0
        expect_same(list(strategy.learned().values()), learned, strategy, "", "to keep no array that it reads")
    return np.array(chosen)


def check_shared(of: Callable[[Ints, Ints], DecisionStrategy], cls: type, sharing: str, groups: Ints) -> None:
    """Raise PluginError unless strategies `of` rows and their groups keep the contract."""
    rng = np.random.default_rng(1)
    steps = rng.normal(size=(8, TEAMS_ROWS, FEATURES))
    whole = of(EVERY, groups)
    chosen = live(whole, steps)
    learned = whole.learned()
    wrong = [name for name, array in learned.items() if array.shape[0] != whole.groups]
    expect(not wrong, cls, "_first_state", f"groups as the first axis of {wrong}")
    expect_same([live(of(EVERY, groups), steps)], [chosen], cls, "", f"the same for the same seed ({sharing})")
    order = np.random.default_rng(3).permutation(TEAMS_ROWS)
    permuted = of(EVERY[order], groups[order])
    said = f"rows in another order to get the same in that order ({sharing})"
    expect_same([live(permuted, steps[:, order])], [chosen[:, order]], cls, "", said)
    expect_same(list(permuted.learned().values()), list(learned.values()), cls, "_update", said)
    alone = {"all": EVERY[:0], "team": EVERY[3:6], "robot": EVERY[100:101]}[sharing]
    said = f"a {sharing} alone to decide as among others"
    expect_same([live(of(alone, groups[alone] * 0), steps[:, alone])], [chosen[:, alone]], cls, "", said)
    other = of(EVERY, groups)
    other.load_learned(learned)
    whole.reseed(EVERY, KEYS)
    said = "to go on from what was learned exactly"
    expect_same([live(other, steps[::-1])], [live(whole, steps[::-1])], cls, "", said)
    allowed = rng.random((TEAMS_ROWS, 4)) < 0.4
    allowed[EVERY, rng.integers(4, size=TEAMS_ROWS)] = True
    live(of(EVERY, groups), steps, allowed)  # `select` refuses options that cannot serve
