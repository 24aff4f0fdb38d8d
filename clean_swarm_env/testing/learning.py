"""The contract of observation terms and of reward terms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.term import TERMS, Term
from clean_swarm_env.learning.reward import REWARD_TERMS
from clean_swarm_env.testing.expecting import expect, expect_registered, expect_same
from selforg.arrays import Floats
from selforg.plugins import contract

BUSY: Final = {"base": "table1", "robots": {"count": 12}, "task": {"garbage": {"count": 30}}}
"""A mission in which much happens."""
FEW: Final = {"base": "table1", "robots": {"count": 3, "capacity": 5}}
"""A mission with rows of robots that are not there."""
SEEDS = [5, 6]
Read = Callable[[Batch], Floats]


def lived(mission: Any, terms: list[Any], seeds: list[int], read: Read, periods: int = 25, order: Any = None) -> Any:  # noqa: ANN401
    """Return what is read in worlds of a mission at the start and after decision periods: (periods + 1, R, ...).

    The robots of all worlds decide alike. Those of one world may start in another order.
    """
    seen_terms: Any = {"observation": {"terms": terms, "full_crowd": 2}} if terms else {}
    batch, rng = Batch(mission, len(seeds), **seen_terms), np.random.default_rng(3)
    start = random_start(batch.mission, seeds[0], 0)
    changed = start.model_copy(update={"robots": tuple(start.robots[k] for k in order)}) if order is not None else None
    batch.reset(seeds, None if changed is None else [changed])
    seen = [read(batch).copy()]
    for _ in range(periods):
        options = rng.integers(0, batch.choices.counts, (batch.robots, len(batch.choices.counts)))
        batch.step(np.tile(options, (batch.count, 1)))
        seen.append(read(batch).copy())
    return np.array(seen)


def check_term(cls: type[Term], mission: Any = BUSY, **settings: float) -> None:  # noqa: ANN401
    """Raise PluginError, one line, unless a registered observation term keeps its contract.

    It says what it means; its components lie within [-1, 1] and are not always zero; they are the same beside other
    terms, in a world alone and among others, for the same seed, and where robots clean also for robots in another
    order; robots that are not there see nothing. `settings`: those of the term.
    """
    expect_registered(cls, TERMS)
    expect(cls.meaning(), cls, "__doc__", "a docstring that says what the components mean, got none")
    own: dict[str, Any] = {"name": cls.name, **settings}
    made = Batch(mission, observation={"terms": [own]})
    names, whole = made.observer.names, [*(one for one in made.worlds.task.terms if one != cls.name), own]
    expect(names and len({*names}) == len(names), cls, "components", f"names that differ, got {names}")

    def read(batch: Batch) -> Floats:
        return np.array(batch.observations[:, [batch.observer.names.index(name) for name in names]], dtype=np.float64)

    seen = lived(mission, [own], SEEDS, read)
    if not seen.any():  # some things come late
        seen = lived(mission, [own], SEEDS, read, 300)
    most, periods = np.abs(seen).max(), len(seen) - 1
    expect(most <= 1.0, cls, "write", f"components within [-1, 1], got {most:g}")
    expect(most > 0.0, cls, "write", "something else than zeros in 300 periods")
    others = lived(mission, whole, SEEDS, read, periods)
    expect_same(others, seen, cls, "write", "the same beside other terms")
    alone, half = lived(mission, [own], SEEDS[:1], read, periods), seen[:, : seen.shape[1] // 2]
    expect_same(alone, half, cls, "write", "the same in a world alone and among others")
    if mission is BUSY:
        order, absent = np.array([*range(5, 12), *range(5)]), lived(FEW, [own], SEEDS[:1], read, 5)[:, 3:]
        permuted = lived(mission, [own], SEEDS[:1], read, 0, order)
        same = cls.numbers_rows or np.array_equal(permuted[0], half[0, order])
        expect(same, cls, "write", "rows in another order to get the same in that order")
        expect(not absent.any(), cls, "write", "nothing in rows of robots that are not there")


def check_reward_term(
    function: Callable[[Batch], Floats],
    mission: Any = BUSY,  # noqa: ANN401  (its name, its keys, ...)
) -> None:
    """Raise PluginError, one line, unless a registered reward term keeps its contract.

    It returns finite numbers (R,), the same if it is asked twice, for the same seed, in a world alone and among others;
    it changes nothing of the batch.
    """
    expect(function in list(REWARD_TERMS), function, "", "to be registered as a reward term")

    def read(batch: Batch) -> Floats:
        kept = (batch.observations, batch.worlds.physics.positions, batch.worlds.physics.headings)
        with contract(function, "", *kept):
            paid, again = np.asarray(function(batch), dtype=np.float64), np.asarray(function(batch))
        good = paid.shape == (batch.rows,) and np.isfinite(paid).all()
        expect(good, function, "", f"finite numbers ({batch.rows},), got {paid.ravel()[:4]} {paid.shape}")
        expect_same([again], [paid], function, "", "the same if it is asked twice")
        return paid

    paid, alone = lived(mission, [], SEEDS, read), lived(mission, [], SEEDS[:1], read)
    expect_same(alone, paid[:, : paid.shape[1] // 2], function, "", "the same in a world alone and among others")
