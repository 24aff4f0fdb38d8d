"""What worlds in one batch and in several have in common: the results of a period, missions that ended, and states."""

from __future__ import annotations

import pickle
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.parts.measure import key_of
from selforg.arrays import Flags, Floats
from selforg.sealing import sealed, unpacked, unsealed

BATCH_STATES = "batch"
"""Kind of the states of worlds, whatever batches they are in."""


class BatchStep(NamedTuple):
    """The result of one decision period; the arrays belong to the batch and are valid until the next call."""

    observations: Observations
    """(R, F) float32; of worlds that have started an episode, its first observations."""
    rewards: Floats
    """(R,) float64."""
    terminated: Flags
    """(W,) whether the task of the world was done in this period: all garbage was dumped."""
    truncated: Flags
    """(W,) whether the time of the world was over with this period and the task was not done."""
    final_observations: Observations
    """(R, F) float32; the observations at the end of the mission, in rows of worlds whose missions ended."""


@dataclass(frozen=True)
class Finished:
    """A mission that ended in the last period."""

    world: int
    """Number of the world in the batch."""
    scenario: Scenario
    """The scenario of the mission."""
    steps: int
    """Number of its decision periods."""
    result: MissionResult
    """The figures of the mission."""
    collision_events: int
    """Number of times that a pair came closer than the first collision distance."""
    totals: Mapping[str, int]
    """Numbers that the task has beside its measures; see `Task.totals`."""
    returns: Sequence[float] = ()
    """Sum of the rewards of each robot that took part, the first to join first; known at the end of the period."""

    @property
    def statistics(self) -> dict[str, Any]:
        """The figures that borders report of a mission."""
        return {
            "duration_s": self.result.duration_s,
            "completed": self.result.completed,
            "mission_collision_events": self.collision_events,
            **{key_of(name): value for name, value in self.result.measures.items()},
            **self.totals,
        }


class ManyWorlds:
    """W worlds in one batch or in several, whose states are the same in any.

    `Batch` and `Joined` share this and no more: one steps worlds, the other asks batches and copies what they return.
    """

    batches: tuple[Any, ...]
    """The batches (`Batch`, which stands above this module), whose worlds come one after the other."""
    options: Mapping[str, tuple[str, ...]]
    """Goal -> names of the options of all batches."""

    def places(self, worlds: Sequence[int] | None = None) -> list[tuple[Any, int]]:
        """Return the batch of each of `worlds` (K,), or of all, and its number there; ValueError for an unknown one."""
        every = [(batch, own) for batch in self.batches for own in range(batch.count)]
        chosen = range(len(every)) if worlds is None else [int(world) for world in worlds]
        for world in chosen:
            if not 0 <= world < len(every):
                raise ValueError(f"worlds: expected 0 to {len(every) - 1}, got {world}")
        return [every[world] for world in chosen]

    def get_state(self, worlds: Sequence[int] | None = None) -> bytes:
        """Return the states of `worlds` (K,), or of all, as sealed bytes that say their version."""
        packed = [pickle.dumps(batch.states.get(own), 5) for batch, own in self.places(worlds)]
        return sealed(BATCH_STATES, packed)

    def set_state(self, state: bytes, worlds: Sequence[int] | None = None) -> Observations:
        """Make `worlds` (K,), or all, go on from `get_state` of K worlds, or of one; return the observations (R, F).

        The further course has the same bits, in batches of the same frame, options and terms. ValueError says what is
        damaged or does not fit, and then nothing has changed.
        """
        places, packed = self.places(worlds), unsealed(BATCH_STATES, state)
        if len(packed) not in (1, len(places)):
            raise ValueError(f"state: expected one world, or {len(places)}, got {len(packed)}")
        states = [(*place, unpacked(packed[k % len(packed)])) for k, place in enumerate(places)]
        for batch, _, one in states:
            batch.check_state(one)
        seen = [batch.enter({own: one for other, own, one in states if other is batch}) for batch in self.batches]
        return np.concatenate(seen)
