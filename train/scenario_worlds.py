"""Worlds that work through scenarios of families one after the other, side by side in one batch of rows.

A world of a batch begins the next scenario by itself when its mission is over. Scenarios of one family and torus share
a frame (`clean_swarm_env.frames`); what differs in it stands beside each other as batches of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.batch import Batch
from clean_swarm_env.config import MissionConfig, StartConfiguration
from clean_swarm_env.families import Scenario
from clean_swarm_env.mission import MissionResult

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Observations = NDArray[np.float32]
Source = Callable[[int], Scenario | None]
"""World of the batch -> the scenario that it does next, None if there is none left."""


class ScenarioBatch(Batch):
    """A batch whose worlds do the scenarios that a `source` gives them.

    Args:
        frame: a mission of the frame that all scenarios share.
        worlds: W.
        source: what each world does next; a world without a scenario stays as it is and counts no more.
        settings: further arguments of `Batch`.

    """

    def __init__(self, frame: MissionConfig, worlds: int, source: Source, **settings: Any) -> None:  # noqa: ANN401
        super().__init__(frame, worlds, **settings)
        self._source = source
        self.current: list[Scenario | None] = [None] * worlds
        """What each world does."""

    def begin(self, source: Source | None = None) -> Observations:
        """Let all worlds begin anew with scenarios of their source, or of a new one."""
        self._source = source or self._source
        return self.reset([0] * self.worlds.worlds)

    def _begin(self, world: int, start: StartConfiguration | None = None) -> None:
        scenario = self.current[world] = self._source(world)
        if scenario is not None:
            self._put(world, scenario.start, scenario.seed, scenario.mission)


@dataclass(frozen=True)
class Done:
    """A mission that a world finished: where, and what it came to."""

    part: int
    """Which of the batches."""
    result: MissionResult


class Moment(NamedTuple):
    """What one decision period brought to all rows (R, ...)."""

    observations: Observations
    """(R, F) of the beginning of the next period, in worlds that began anew of their new mission."""
    rewards: Floats
    """(R,)."""
    over: Flags
    """(R,) whether the mission of the row ended with the period."""
    truncated: Flags
    """(R,) whether it did because its time was over."""
    final: Observations
    """(R, F) what rows saw whose mission ended."""
    done: tuple[Done, ...]
    """The missions that ended."""


class JoinedWorlds:
    """Batches side by side: the rows of all of them, one after the other.

    Attributes:
        rows: number of rows of all batches.
        names: (F,) names of the components of an observation.

    """

    def __init__(self, batches: Sequence[ScenarioBatch]) -> None:
        self.batches = tuple(batches)
        self.rows = sum(batch.rows for batch in self.batches)
        self.names = self.batches[0].observer.names
        self.options = next(iter(self.batches[0].options.values()))
        self._cuts = np.cumsum([batch.rows for batch in self.batches])[:-1]

    @property
    def worlds_of_rows(self) -> Ints:
        """(R,) number of the world of each row, counted over all batches."""
        sizes = [batch.robots for batch in self.batches for _ in range(batch.worlds.worlds)]
        return np.repeat(np.arange(len(sizes)), sizes)

    def begin(self, sources: Sequence[Source]) -> Observations:
        """Let all worlds begin anew, each batch with its source; return observations (R, F)."""
        seen = [batch.begin(source) for batch, source in zip(self.batches, sources, strict=True)]
        return np.concatenate(seen)

    @property
    def present(self) -> Flags:
        """(R,) whether there is a robot at work in the row."""
        return np.concatenate([batch.worlds.physics.present for batch in self.batches])

    def step(self, options: Ints) -> Moment:
        """Let all rows hold `options` (R,) for one decision period."""
        steps = [batch.step(own) for batch, own in zip(self.batches, np.split(options, self._cuts), strict=True)]
        robots = [batch.robots for batch in self.batches]
        ended = [np.repeat(s.terminated | s.truncated, n) for s, n in zip(steps, robots, strict=True)]
        cut = [np.repeat(s.truncated, n) for s, n in zip(steps, robots, strict=True)]
        done = [Done(part, end.result) for part, batch in enumerate(self.batches) for end in batch.finished]
        return Moment(
            np.concatenate([step.observations for step in steps]),
            np.concatenate([step.rewards for step in steps]),
            np.concatenate(ended),
            np.concatenate(cut),
            np.concatenate([step.final_observations for step in steps]),
            tuple(done),
        )
