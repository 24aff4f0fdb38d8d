"""What a batch of worlds returns: the results of a decision period, and missions that have ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.parts.measure import key_of
from selforg.arrays import Flags, Floats


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
    result: MissionResult
    """The figures of the mission."""
    collision_events: int
    """Number of times that a pair came closer than the first collision distance."""
    totals: Mapping[str, int]
    """Numbers that the task has beside its measures; see `Task.totals`."""

    @property
    def statistics(self) -> dict[str, Any]:
        """The figures that borders report of a mission."""
        result = self.result
        figures = {"duration_s": result.duration_s, "completed": result.completed}
        figures["mission_collision_events"] = self.collision_events
        return figures | {key_of(name): value for name, value in result.measures.items()} | dict(self.totals)
