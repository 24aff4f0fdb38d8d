"""States of the worlds of a batch: those of the worlds themselves, and how far mission and episodes have come."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from typing import Any, NamedTuple

from numpy.typing import NDArray

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.learning.episodes import Series
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.world.world_state import WorldState, bytes_of, fill, likeness_of
from clean_swarm_env.world.worlds import Worlds
from selforg.sealing import check_alike, sealed, unsealed


class BatchState(NamedTuple):
    """Everything that decides how the episodes of one world continue, except a source that the user wrote."""

    likeness: dict[str, Any]  # what both batches must have in common beside their worlds
    world: WorldState
    doing: Scenario | None
    series: tuple[int, int, int] | None  # seed, number and step of the next episode
    rows: bytes  # of the arrays (R, ...), one after the other
    counts: bytes  # of the arrays (W, ...)


Opened = list[tuple[int, BatchState]]
"""Numbers of worlds, and the states from which they can go on."""


class BatchStates:
    """Takes states out of the worlds of a batch, and puts them in; `terms` are the components of its observations."""

    def __init__(
        self,
        worlds: Worlds,
        series: Series,
        doing: list[Scenario | None],
        progress: MissionProgress,
        observations: NDArray[Any],
        terms: tuple[str, ...],
    ) -> None:
        self._worlds, self._series, self._doing = worlds, series, doing
        self._rows, self._counts = (observations, *progress.of_rows()), progress.of_worlds()
        self._likeness = {"terms": terms, "arrays": likeness_of((*self._rows, *self._counts))}

    def get(self, worlds: Sequence[int] | None) -> bytes:
        """Return the states of `worlds` (K,), or of all."""
        return sealed("batch", [pickle.dumps(self._state_of(world), 5) for world in self._numbers(worlds)])

    def open(self, state: bytes, worlds: Sequence[int] | None) -> Opened:
        """Return from what `worlds` (K,), or all, can go on: the states of as many, or of one.

        ValueError says what is damaged or does not fit.
        """
        packed, chosen = unsealed("batch", state), self._numbers(worlds)
        if len(packed) not in (1, len(chosen)):
            raise ValueError(f"state: expected one world, or {len(chosen)}, got {len(packed)}")
        states = [(world, pickle.loads(packed[number % len(packed)])) for number, world in enumerate(chosen)]
        for _, of_world in states[: len(packed)]:
            check_alike(self._likeness, of_world.likeness)
            self._worlds.check_state(of_world.world)
        return states

    def put(self, states: Opened) -> None:
        """Make worlds go on from what `open` has returned."""
        for world, state in states:
            rows = self._worlds.rows_of(world)
            self._worlds.put_state(world, state.world)
            fill(self._rows, slice(int(rows[0]), int(rows[-1]) + 1), state.rows)
            fill(self._counts, slice(world, world + 1), state.counts)
            self._doing[world] = state.doing
            self._series.go_on(world, state.series)

    def _numbers(self, worlds: Sequence[int] | None) -> list[int]:
        """Return the numbers of `worlds`, or of all; ValueError for one that does not exist."""
        chosen = list(range(self._worlds.worlds)) if worlds is None else [int(world) for world in worlds]
        for world in chosen:
            if not 0 <= world < self._worlds.worlds:
                raise ValueError(f"worlds: expected 0 to {self._worlds.worlds - 1}, got {world}")
        return chosen

    def _state_of(self, world: int) -> BatchState:
        """Return the state of a world."""
        rows = self._worlds.rows_of(world)
        own = bytes_of(self._rows, slice(int(rows[0]), int(rows[-1]) + 1))
        counts, series = bytes_of(self._counts, slice(world, world + 1)), self._series.next_of(world)
        return BatchState(self._likeness, self._worlds.state_of(world), self._doing[world], series, own, counts)
