"""States of the worlds of a batch: those of the worlds themselves, and how far mission and episodes have come."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from numpy.typing import NDArray

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.learning.episodes import Series
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.world.world_state import WorldState, bytes_of, fill, from_bytes, to_bytes
from clean_swarm_env.world.worlds import Worlds


class BatchState(NamedTuple):
    """All that the further episodes of one world depend on, but for a source of the user's own."""

    world: WorldState
    doing: Scenario | None
    series: tuple[int, int, int] | None  # seed, number and step of the next episode
    rows: bytes  # of the arrays (R, ...), one after the other
    counts: bytes  # of the arrays (W, ...)


class BatchStates:
    """Takes states out of the worlds of a batch, and puts them in."""

    def __init__(
        self,
        worlds: Worlds,
        series: Series,
        doing: list[Scenario | None],
        progress: MissionProgress,
        *rows: NDArray[Any],
    ) -> None:
        self._worlds, self._series, self._doing = worlds, series, doing
        self._rows, self._counts = (*rows, *progress.of_rows()), progress.of_worlds()

    def get(self, worlds: Sequence[int] | None) -> bytes:
        """Return the states of `worlds` (K,), or of all."""
        return to_bytes([self._take(world) for world in self._numbers(worlds)])

    def set(self, packed: bytes, worlds: Sequence[int] | None) -> list[int]:
        """Make `worlds` (K,), or all, go on from the states of as many or of one; return their numbers.

        ValueError says what does not fit.
        """
        states, chosen = from_bytes(packed), self._numbers(worlds)
        if not isinstance(states, list) or len(states) not in (1, len(chosen)):
            raise ValueError(f"state: expected one world, or {len(chosen)}, got {len(states)}")
        for number, world in enumerate(chosen):
            self._put(world, states[number % len(states)])
        return chosen

    def _numbers(self, worlds: Sequence[int] | None) -> list[int]:
        """Return the numbers of `worlds`, or of all; ValueError for one that does not exist."""
        chosen = list(range(self._worlds.worlds)) if worlds is None else [int(world) for world in worlds]
        for world in chosen:
            if not 0 <= world < self._worlds.worlds:
                raise ValueError(f"worlds: expected 0 to {self._worlds.worlds - 1}, got {world}")
        return chosen

    def _take(self, world: int) -> bytes:
        """Return the state of a world."""
        rows = self._worlds.rows_of(world)
        part = slice(int(rows[0]), int(rows[-1]) + 1)
        own, series = bytes_of(self._rows, part), self._series.next_of(world)
        counts = bytes_of(self._counts, slice(world, world + 1))
        return to_bytes(BatchState(self._worlds.state_of(world), self._doing[world], series, own, counts))

    def _put(self, world: int, packed: bytes) -> None:
        """Make a world go on from a state; ValueError if it does not fit."""
        state: BatchState = from_bytes(packed)
        rows = self._worlds.rows_of(world)
        self._worlds.put_state(world, state.world)
        fill(self._rows, slice(int(rows[0]), int(rows[-1]) + 1), state.rows)
        fill(self._counts, slice(world, world + 1), state.counts)
        self._doing[world] = state.doing
        self._series.go_on(world, state.series)
