"""Batches side by side: one learner decides for worlds of different missions, families and sizes.

Rows are those of all batches, one batch after the other. The same holds for worlds. Several threads may step the
batches: a batch touches nothing of the others, and its long kernels hold no lock of Python.
"""

from __future__ import annotations

import os
from bisect import bisect
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace
from functools import cache, partial
from itertools import accumulate
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.batch import BATCH_STATES, Batch
from clean_swarm_env.learning.episodes import Size
from clean_swarm_env.learning.given import GivenMission, seeds_from, whole_number, world_seeds
from clean_swarm_env.learning.interface import BatchStep, Finished
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.states import Opened
from selforg.arrays import Flags, Ints
from selforg.sealing import sealed, unsealed

Returned = TypeVar("Returned")


class Joined:
    """Several batches used as one. The caller owns the arrays that are returned.

    Args:
        batches: B batches, at least one, with the same kind of actions and the same observations. Options are those of
            all batches, by name. Where a batch lacks the option of an action, the option of the highest expert score
            serves; actions for goals that it does not coordinate are ignored. `masks` says what each row has.
        threads: number of threads that step the batches; the results are the same with any.

    Attributes:
        options: goal -> names of the options of all batches.
        counts: (C,) number of options of each goal.
        rows: R, number of rows of all batches.
        worlds: W, number of worlds of all batches.
        world_of: (R,) int64, world of each row.
        first_rows: (W,) int64, first row of each world.

    >>> joined = Joined([Batch(worlds=2), *family_batches("random", 1, knowledge="cleaning")])
    >>> joined.reset([5, 6, 7]).shape == (joined.rows, joined.batches[0].observer.width)
    True
    >>> joined.step(np.zeros(joined.rows, dtype=np.int64)).terminated.shape
    (3,)

    """

    def __init__(self, batches: Sequence[Batch], threads: int = 1) -> None:
        self.batches = tuple(batches)
        self._threads = min(whole_number(threads, "threads", 1), len(self.batches))
        _check_alike(self.batches)
        self.rows = sum(batch.rows for batch in batches)
        robots = np.array([batch.robots for batch in batches for _ in range(batch.count)])
        self.worlds = len(robots)
        self.world_of: Ints = np.repeat(np.arange(self.worlds), robots)
        self.first_rows: Ints = np.cumsum(robots) - robots
        self._cuts = list(accumulate(batch.rows for batch in batches))[:-1]
        self._first_worlds = list(accumulate((batch.count for batch in batches), initial=0))[:-1]
        self.options: dict[str, tuple[str, ...]] = {}
        for batch in self.batches:
            for goal, names in batch.options.items():
                self.options[goal] = tuple(dict.fromkeys((*self.options.get(goal, ()), *names)))
        self.counts = tuple(map(len, self.options.values()))
        self._alike = all(list(batch.options.items()) == list(self.options.items()) for batch in self.batches)
        order, goals = each_option(self.options), list(self.options)
        self._places = [[order.index(option) for option in each_option(batch.options)] for batch in self.batches]
        self._lacking = [
            [order.index((goal, names[0])) for goal, names in self.options.items() if goal not in batch.options]
            for batch in self.batches
        ]
        self._columns = [[goals.index(goal) for goal in batch.options] for batch in self.batches]
        self._numbers = [
            [
                np.array([names.index(name) if name in names else default for name in self.options[goal]])
                for (goal, names), default in zip(batch.options.items(), batch.choices.default.tolist(), strict=True)
            ]
            for batch in self.batches
        ]

    def reset(
        self, seeds: Sequence[int | None] | None = None, starts: Sequence[StartConfiguration | None] | None = None
    ) -> Observations:
        """Begin an episode in every world and return the observations (R, F); see `Batch.reset`."""
        nothing = [None] * self.worlds
        for name, given in (("seeds", seeds), ("starts", starts)):
            if given is not None and len(given) != self.worlds:
                raise ValueError(f"{name}: expected one for each of {self.worlds} worlds, got {len(given)}")
        seen = []
        for batch, first in zip(self.batches, self._first_worlds, strict=True):
            own = slice(first, first + batch.count)
            seen.append(batch.reset((seeds or nothing)[own], (starts or nothing)[own]))
        return np.concatenate(seen)

    def reset_worlds(
        self,
        worlds: Ints,
        seeds: Sequence[int | None] | None = None,
        starts: Sequence[StartConfiguration | None] | None = None,
    ) -> Observations:
        """Begin an episode in `worlds` (K,) only and return the observations (R, F); see `Batch.reset_worlds`."""
        nothing, seen = [None] * self.worlds, []
        for batch, first in zip(self.batches, self._first_worlds, strict=True):
            own, inside = slice(first, first + batch.count), (first <= worlds) & (worlds < first + batch.count)
            known = (worlds[inside] - first, (seeds or nothing)[own], (starts or nothing)[own])
            seen.append(batch.reset_worlds(*known) if inside.any() else batch.observations)
        return np.concatenate(seen)

    def seeds_of(self, given: int | Sequence[int | None] | None) -> list[int | None]:
        """Return the seeds of all worlds (W,): children of one number, or those of a list, of worlds or of rows."""
        if given is None:
            return [None] * self.worlds
        if isinstance(given, Sequence | np.ndarray) and not isinstance(given, str):
            by_rows = len(given) == self.rows
            return seeds_from([given[row] for row in self.first_rows] if by_rows else given, self.worlds)
        return [*world_seeds(given, self.worlds)]

    def step(self, actions: NDArray[Any]) -> BatchStep:
        """Run one decision period; see `Batch.step`."""
        if actions.shape[:1] != (self.rows,):
            raise ValueError(f"actions: expected one for each of {self.rows} rows, got shape {actions.shape}")
        own = [self._own(k, part) for k, part in enumerate(np.split(actions, self._cuts))]
        for batch, part in zip(self.batches, own, strict=True):  # all, before any batch goes on
            batch.choices.checked(part, batch.rows)
        steps = in_threads(
            [partial(batch.step, part) for batch, part in zip(self.batches, own, strict=True)], self._threads
        )
        return BatchStep(*(np.concatenate(arrays) for arrays in zip(*steps, strict=True)))

    def place_of(self, world: int) -> tuple[Batch, int]:
        """Return the batch of a world, and its number there; ValueError for a world that does not exist."""
        if not 0 <= world < self.worlds:
            raise ValueError(f"worlds: expected 0 to {self.worlds - 1}, got {world}")
        k = bisect(self._first_worlds, world) - 1
        return self.batches[k], world - self._first_worlds[k]

    def get_state(self, worlds: Sequence[int] | None = None) -> bytes:
        """Return the states of `worlds` (K,), or of all, as `Batch.get_state` does, whatever the batches are."""
        places = [self.place_of(int(world)) for world in (range(self.worlds) if worlds is None else worlds)]
        return sealed(
            BATCH_STATES, [one for batch, own in places for one in unsealed(BATCH_STATES, batch.get_state([own]))]
        )

    def set_state(self, state: bytes, worlds: Sequence[int] | None = None) -> Observations:
        """Make `worlds` (K,), or all, go on from `get_state`; return the observations (R, F); see `Batch.set_state`."""
        places = [self.place_of(int(world)) for world in (range(self.worlds) if worlds is None else worlds)]
        packed = unsealed(BATCH_STATES, state)
        if len(packed) not in (1, len(places)):
            raise ValueError(f"state: expected one world, or {len(places)}, got {len(packed)}")
        opened: list[Opened] = [[] for _ in self.batches]
        for number, (batch, own) in enumerate(places):
            one = sealed(BATCH_STATES, [packed[number % len(packed)]])
            opened[self.batches.index(batch)] += batch.open_state(one, [own])
        return np.concatenate([batch.enter_state(own) for batch, own in zip(self.batches, opened, strict=True)])

    @property
    def over(self) -> Flags:
        """(W,) whether the mission of a world is over and no other has begun."""
        return np.concatenate([batch.over for batch in self.batches])

    def close(self) -> None:
        """End the recordings of missions that are still going on."""
        for batch in self.batches:
            batch.close()

    @property
    def finished(self) -> tuple[Finished, ...]:
        """The missions that ended in the last period."""
        return tuple(
            replace(end, world=first + end.world)
            for batch, first in zip(self.batches, self._first_worlds, strict=True)
            for end in batch.finished
        )

    @property
    def working(self) -> Flags:
        """(R,) whether there is a robot that works in the row."""
        return np.concatenate([batch.working for batch in self.batches])

    def masks(self) -> Flags:
        """Return which options (R, O) can serve in the coming period; the first one of a goal that a batch lacks."""
        masks = np.zeros((self.rows, sum(self.counts)), dtype=np.bool_)
        parts = np.split(masks, self._cuts)
        for batch, rows, lacking, places in zip(self.batches, parts, self._lacking, self._places, strict=True):
            rows[:, lacking] = True
            rows[:, places] = batch.masks()
        return masks

    def defaults(self) -> Ints:
        """Return the option (R, C) of the highest expert score of each goal; 0 for goals that a batch lacks."""
        options = np.zeros((self.rows, len(self.options)), dtype=np.int64)
        for batch, rows, columns in zip(self.batches, np.split(options, self._cuts), self._columns, strict=True):
            best = [names[k] for names, k in zip(batch.options.values(), batch.choices.default, strict=True)]
            rows[:, columns] = [self.options[goal].index(name) for goal, name in zip(batch.options, best, strict=True)]
        return options

    def _own(self, number: int, actions: NDArray[Any]) -> NDArray[Any]:
        """Return the actions (rows of batch `number`, ...) by the numbers of its own goals and options."""
        batch = self.batches[number]
        if self._alike or batch.action.mode == "velocity":
            return actions
        given = actions.reshape(len(actions), -1)
        own = [given[:, column].astype(np.int64) for column in self._columns[number]]
        for numbers, known in zip(own, self._numbers[number], strict=True):
            fit = (numbers >= 0) & (numbers < len(known))  # others are an error of the batch
            numbers[fit] = known[numbers[fit]]
        return np.column_stack([*own, given[:, len(self.options) :]])


def in_threads(calls: Sequence[Callable[[], Returned]], threads: int) -> list[Returned]:
    """Return the results of calls that touch nothing of each other, made by a number of threads.

    An error or Ctrl-C is raised when all calls have ended, so that none goes on behind the caller's back.
    """
    if threads == 1:
        return [call() for call in calls]
    running = [_pool(threads, os.getpid()).submit(call) for call in calls]
    try:
        return [one.result() for one in running]
    finally:
        wait(running)


@cache
def _pool(threads: int, process: int) -> ThreadPoolExecutor:
    """Return the threads of a process; one that is forked has none of those of its parent."""
    return ThreadPoolExecutor(threads, "clean-swarm")


def blocks(
    mission: GivenMission | None = None,
    worlds: int = 1,
    threads: int = 1,
    **settings: Any,  # noqa: ANN401  (those of Batch)
) -> list[Batch]:
    """Return batches of one mission or family for a number of threads, with `worlds` worlds altogether.

    The worlds have the courses that they have in one batch. Those that are recorded, or have a source, stay together.
    """
    together = settings.get("record") is not None or settings.get("source") is not None
    parts = 1 if together else min(whole_number(threads, "threads", 1), whole_number(worlds, "worlds", 1))
    return [Batch(mission, len(range(k, worlds, parts)), **settings) for k in range(parts)]


def family_batches(
    family: FamilyConfig | str,
    worlds: int,
    *,
    sizes: Sequence[Size] = (),
    threads: int = 1,
    directories: tuple[Path, ...] = (),
    **settings: Any,  # noqa: ANN401  (those of Batch)
) -> list[Batch]:
    """Return batches for the scenarios of a family, `blocks` of each torus, with `worlds` worlds altogether.

    The worlds are dealt out to the tori in turn. `sizes` are these tori in their order, all of the family unless given.
    """
    known = load_family(family, directories, trust=settings.get("trust", False)) if isinstance(family, str) else family
    tori = tuple(sizes) or known.tori
    counts = [len(range(k, worlds, len(tori))) for k in range(len(tori))]
    return [
        batch
        for size, count in zip(tori, counts, strict=True)
        if count
        for batch in blocks(None, count, threads, family=known, size=size, directories=directories, **settings)
    ]


def each_option(options: Mapping[str, Sequence[str]]) -> list[tuple[str, str]]:
    """Return goal and name of each option, in the order of masks."""
    return [(goal, name) for goal, names in options.items() for name in names]


def _check_alike(batches: Sequence[Batch]) -> None:
    """Raise an error if there are no batches, or if one learner cannot decide for all of them."""
    if not batches:
        raise ValueError("batches: expected at least one, got none")
    if len({id(batch) for batch in batches}) < len(batches):
        raise ValueError("batches: expected each one once, got one twice")
    first = _compared(batches[0])
    for number, batch in enumerate(batches):
        for what, given in _compared(batch).items():
            if given != first[what]:
                expected = f"{first[what]} as in the first"
                raise ConfigurationError(f"batches[{number}]: {what}: expected {expected}, got {given}")


def _compared(batch: Batch) -> dict[str, Any]:
    """Return the settings that must be equal in batches that are joined."""
    return {
        "action": batch.action.model_dump(),
        "observations and their bounds": dict(zip(batch.observer.names, batch.observer.bounds.tolist(), strict=True)),
    }
