"""Batches side by side: one learner decides for worlds of different missions, families and sizes.

Rows are those of all batches, one batch after the other. The same holds for worlds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.episodes import Size
from clean_swarm_env.learning.interface import BatchStep, Finished
from clean_swarm_env.learning.observation.observer import Observations
from selforg.arrays import Flags, Ints


class Joined:
    """Several batches used as one. The caller owns the arrays that are returned.

    Args:
        batches: B batches, at least one, with the same kind of actions and the same observations. Options are those of
            all batches, by name. Where a batch lacks the option of an action, the option of the highest expert score
            serves; actions for goals that it does not coordinate are ignored. `masks` says what each row has.

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

    def __init__(self, batches: Sequence[Batch]) -> None:
        self.batches = tuple(batches)
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

    def step(self, actions: NDArray[Any]) -> BatchStep:
        """Run one decision period; see `Batch.step`."""
        if actions.shape[:1] != (self.rows,):
            raise ValueError(f"actions: expected one for each of {self.rows} rows, got shape {actions.shape}")
        parts = np.split(actions, self._cuts)
        steps = [
            batch.step(self._own(k, part)) for k, (batch, part) in enumerate(zip(self.batches, parts, strict=True))
        ]
        return BatchStep(*(np.concatenate(arrays) for arrays in zip(*steps, strict=True)))

    @property
    def finished(self) -> tuple[Finished, ...]:
        """The missions that ended in the last period."""
        return tuple(
            replace(end, world=first + end.world)
            for batch, first in zip(self.batches, self._first_worlds, strict=True)
            for end in batch.finished
        )

    @property
    def present(self) -> Flags:
        """(R,) whether there is a robot in the row."""
        return np.concatenate([batch.worlds.physics.present for batch in self.batches])

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


def family_batches(
    family: FamilyConfig | str,
    worlds: int,
    *,
    sizes: Sequence[Size] = (),
    directories: tuple[Path, ...] = (),
    **settings: Any,  # noqa: ANN401  (those of Batch)
) -> list[Batch]:
    """Return batches for the scenarios of a family, one for each torus, with `worlds` worlds altogether.

    The worlds are dealt out to the tori in turn. `sizes` are these tori in their order, all of the family unless given.
    """
    known = load_family(family, directories, trust=settings.get("trust", False)) if isinstance(family, str) else family
    tori = tuple(sizes) or known.tori
    counts = [len(range(k, worlds, len(tori))) for k in range(len(tori))]
    return [
        Batch(family=known, size=size, worlds=count, directories=directories, **settings)
        for size, count in zip(tori, counts, strict=True)
        if count
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
