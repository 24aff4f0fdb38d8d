"""The result of a mission, and its control periods."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from clean_swarm_env.world.worlds import Worlds

PERIOD_ROUNDING = 1e-9
"""A time this little before the beginning of a control period belongs to that period [periods]."""


@dataclass(frozen=True)
class MissionResult:
    """The figures of a mission that is over, in the order of the columns of `runs.csv`."""

    completed: bool
    """Whether all garbage was dumped in time, or all measures of the task met their targets."""
    duration_s: float
    """Time at which the last item was dumped, or the task was done, or the time limit [s]."""
    collision_samples_per_s: tuple[float, ...]
    """For each collision distance, pairs closer than it, counted at every physics step [1/s]."""
    collision_events_per_s: tuple[float, ...]
    """For each collision distance, pairs that came closer than it [1/s]."""
    garbage_done: int
    """Items dumped."""
    robots: int
    """Robots that took part."""
    ticks: int
    """Control periods run."""
    items_per_min: float
    """Items dumped per minute [1/min]."""
    cost_s: float
    """See `Task.cost` [s]."""
    unavoidable_s: float
    """The part of the cost that nobody could avoid [s]."""
    measures: Mapping[str, float] = field(default_factory=dict)
    """The measures of the task by name; cleaning has none."""

    @property
    def excess_s(self) -> float:
        """The part of the cost that is compared [s]."""
        return self.cost_s - self.unavoidable_s

    def as_mapping(self) -> dict[str, Any]:
        """Return the figures as plain data; without `measures` where there are none."""
        figures = asdict(self)
        return figures if self.measures else {name: figures[name] for name in figures if name != "measures"}


def period_of(time: float, control_rate: float) -> int:
    """Return the number of the control period in which `time` [s] lies; -1 for no time of a mission."""
    if not (math.isfinite(time) and time >= 0.0):
        return -1
    return math.floor(min(time * control_rate + PERIOD_ROUNDING, sys.maxsize))


def result_of(worlds: Worlds, world: int) -> MissionResult:
    """Return the result of a world up to now."""
    task, values = worlds.task, worlds.task.result()
    ticks, totals = int(worlds.ticks[world]), task.totals()
    done = int(totals["garbage_done"][world]) if "garbage_done" in totals else 0
    time = max(ticks, 1) * worlds.period
    events, samples = worlds.collisions.events[world], worlds.collisions.samples[world]
    return MissionResult(
        completed=bool(task.completed(values)[world]),
        duration_s=round(float(task.duration(world)), 9),
        collision_samples_per_s=tuple((samples / time).tolist()),
        collision_events_per_s=tuple((events / time).tolist()),
        garbage_done=done,
        robots=int(worlds.team.joined[world]),
        ticks=ticks,
        items_per_min=60.0 * done / time,
        cost_s=float(task.cost(world, values)),
        unavoidable_s=float(task.unavoidable(world)),
        measures={name: float(own[world]) for name, own in values.items()},
    )
