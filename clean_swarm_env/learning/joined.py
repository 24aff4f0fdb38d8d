"""Batches side by side: one learner decides for worlds of different missions, families and sizes.

Rows are those of all batches, one batch after the other. The same holds for worlds. Several threads may step the
batches: a batch touches nothing of the others, and its long kernels hold no lock of Python.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace
from functools import cache, partial
from itertools import accumulate
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.episodes import EnvSettings, Size, episodes_of
from clean_swarm_env.learning.given import GivenMission, of_each, seeds_from, whole_number
from clean_swarm_env.learning.interface import BatchStep, Finished, ManyWorlds
from clean_swarm_env.learning.observation.observer import Observations
from selforg.arrays import Flags, Ints

Returned = TypeVar("Returned")


class Joined(ManyWorlds):
    """Several batches used as one. The caller owns the arrays that are returned.

    Args:
        batches: B batches, at least one, with the same kind of actions and the same observations. Options are those of
            all batches, by name. Where a batch lacks the option of an action, the option of the highest expert score
            serves; actions for goals that it does not coordinate are ignored. `masks` says what each row has.
        threads: number of threads that step the batches; the results are the same with any.

    Attributes:
        options: goal -> names of the options of all batches.
        rows: R, number of rows of all batches.
        count: W, number of worlds of all batches.
        world_of: (R,) int64, world of each row.
        first_rows: (W,) int64, first row of each world.

    >>> joined = Joined([Batch(worlds=2), *batches_of("random", 1, knowledge="cleaning")])
    >>> joined.reset([5, 6, 7]).shape == (joined.rows, joined.batches[0].observer.width)
    True
    >>> joined.step(np.zeros(joined.rows, dtype=np.int64)).terminated.shape
    (3,)

    """

    def __init__(self, batches: Sequence[Batch], threads: int = 1) -> None:
        self.batches: tuple[Batch, ...] = tuple(batches)
        self._threads = min(whole_number(threads, "threads", 1), len(self.batches))
        _check_alike(self.batches)
        robots = np.array([batch.robots for batch, _ in self.places()])
        self.rows, self.count = int(robots.sum()), len(robots)
        self.world_of: Ints = np.repeat(np.arange(self.count), robots)
        self.first_rows: Ints = np.cumsum(robots) - robots
        self._cuts = list(accumulate(batch.rows for batch in batches))[:-1]
        self._first_worlds = list(accumulate((batch.count for batch in batches), initial=0))[:-1]
        options: dict[str, tuple[str, ...]] = {}
        for batch in self.batches:
            for goal, names in batch.options.items():
                options[goal] = tuple(dict.fromkeys((*options.get(goal, ()), *names)))
        self.options = options
        self._own = [
            None
            if batch.action.mode == "velocity" or [*batch.options.items()] == [*self.options.items()]
            else OwnOptions(batch, self.options)
            for batch in self.batches
        ]

    def reset(
        self,
        seeds: int | Sequence[int | None] | None = None,
        starts: Sequence[StartConfiguration | None] | None = None,
        worlds: Ints | None = None,
    ) -> Observations:
        """Begin an episode in every world, or in `worlds` (K,) only; return the observations (R, F); see `Batch.reset`.

        A list of seeds may also have one for each row.
        """
        known = seeds_from(seeds, self.first_rows.tolist(), self.rows)
        begun, seen = of_each(starts, self.count, "starts"), []
        for batch, first in zip(self.batches, self._first_worlds, strict=True):
            last = first + batch.count
            own = None if worlds is None else worlds[(first <= worlds) & (worlds < last)] - first
            seen.append(batch.reset(known[first:last], begun[first:last], own))
        return np.concatenate(seen)

    def step(self, actions: NDArray[Any]) -> BatchStep:
        """Run one decision period; see `Batch.step`."""
        if actions.shape[:1] != (self.rows,):
            raise ValueError(f"actions: expected one for each of {self.rows} rows, got shape {actions.shape}")
        parts = np.split(actions, self._cuts)
        own = [part if known is None else known.actions(part) for part, known in zip(parts, self._own, strict=True)]
        for batch, part in zip(self.batches, own, strict=True):  # all, before any batch goes on
            batch.choices.checked(part, batch.rows)
        steps = in_threads(
            [partial(batch.step, part) for batch, part in zip(self.batches, own, strict=True)], self._threads
        )
        return BatchStep(*(np.concatenate(arrays) for arrays in zip(*steps, strict=True)))

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
        each = [(batch.masks(), own) for batch, own in zip(self.batches, self._own, strict=True)]
        return np.concatenate([masks if own is None else own.masks(masks) for masks, own in each])

    def defaults(self) -> Ints:
        """Return the option (R, C) of the highest expert score of each goal; 0 for goals that a batch lacks."""
        best = [
            {goal: names[k] for (goal, names), k in zip(b.options.items(), b.choices.default, strict=True)}
            for b in self.batches
        ]
        own = [[names.index(one[goal]) if goal in one else 0 for goal, names in self.options.items()] for one in best]
        return np.repeat(own, [batch.rows for batch in self.batches], axis=0)


class OwnOptions:
    """The options of a batch beside those of several batches, by goal and name."""

    def __init__(self, batch: Batch, options: Mapping[str, Sequence[str]]) -> None:
        own, goals = each_option(batch.options), list(options)
        lacking = [(goal, names[0]) for goal, names in options.items() if goal not in batch.options]
        self._sources = [own.index(one) if one in own else len(own) + (one in lacking) for one in each_option(options)]
        self._columns, self._goals = [goals.index(goal) for goal in batch.options], len(goals)
        self._numbers = [
            np.array([names.index(name) if name in names else default for name in options[goal]])
            for (goal, names), default in zip(batch.options.items(), batch.choices.default.tolist(), strict=True)
        ]

    def actions(self, actions: NDArray[Any]) -> NDArray[Any]:
        """Return actions (K, ...) by the numbers of the batch's own goals and options."""
        given = actions.reshape(len(actions), -1)
        own = [given[:, column].astype(np.int64) for column in self._columns]
        for numbers, known in zip(own, self._numbers, strict=True):
            fit = (numbers >= 0) & (numbers < len(known))  # others are an error of the batch
            numbers[fit] = known[numbers[fit]]
        return np.column_stack([*own, given[:, self._goals :]])

    def masks(self, masks: Flags) -> Flags:
        """Return the masks (K, O) of all options: those of the batch, and the first one of each goal that it lacks."""
        never, always = np.zeros((2, len(masks)), dtype=np.bool_)
        return np.column_stack([masks, never, ~always])[:, self._sources]


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


def batches_of(
    mission: GivenMission | None = None,
    worlds: int = 1,
    threads: int = 1,
    *,
    sizes: Sequence[Size] = (),
    **settings: Any,  # noqa: ANN401  (those of Batch)
) -> list[Batch]:
    """Return batches for a number of threads with `worlds` worlds of a mission or family altogether.

    The worlds are dealt out in turn to the tori of a family, or to `sizes`, some of these. They have the courses that
    they have in one batch. Those that are recorded, or have a source, stay together.
    """
    together = settings.get("record") is not None or settings.get("source") is not None
    threads = 1 if together else whole_number(threads, "threads", 1)
    episodes = episodes_of(mission, cast(EnvSettings, settings))
    known = {"family" if isinstance(episodes.source, FamilyConfig) else "mission": episodes.source}
    tori = tuple(sizes) or ((episodes.size,) if episodes.size else episodes.tori)
    counts = [len(range(k, whole_number(worlds, "worlds", 1), len(tori))) for k in range(len(tori))]
    if together and len(used := [size for size, count in zip(tori, counts, strict=True) if count]) > 1:
        raise ValueError(f"size: expected one torus for worlds that are recorded or have a source, got {used}")
    return [
        Batch(worlds=len(range(k, count, min(threads, count))), **{**settings, **known, "size": size})
        for size, count in zip(tori, counts, strict=True)
        for k in range(min(threads, count))
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
    observed = [dict(zip(batch.observer.names, batch.observer.bounds.tolist(), strict=True)) for batch in batches]
    compared: dict[str, list[Any]] = {"action": [b.action for b in batches], "observations and their bounds": observed}
    for what, each in compared.items():
        for number, given in enumerate(each):
            if given != each[0]:
                expected = f"{each[0]} as in the first"
                raise ConfigurationError(f"batches[{number}]: {what}: expected {expected}, got {given}")
