"""One run: a mission of an experiment under one condition; many runs, one after the other or in several processes."""

import os
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import for_start, run_seed
from selector.coordination.selection import BY_SCORE
from selector.strategies.registry import StrategySpec
from train.running.processes import each_done


class MissionOutcome(Protocol):
    """What a mission returns, as `clean_swarm_env.world.mission.MissionResult` does."""

    @property
    def completed(self) -> bool:
        """Whether all items were dumped within the time limit."""

    @property
    def duration_s(self) -> float:
        """Simulated time until the last item was dumped, or the time limit [s]."""

    @property
    def collision_samples_per_s(self) -> tuple[float, ...]:
        """Samples of pairs closer than each collision distance [1/s]."""

    @property
    def collision_events_per_s(self) -> tuple[float, ...]:
        """Pairs that came closer than each collision distance [1/s]."""

    @property
    def garbage_done(self) -> int:
        """Number of items dumped."""

    @property
    def robots(self) -> int:
        """Number of robots."""

    @property
    def ticks(self) -> int:
        """Number of control periods."""

    @property
    def items_per_min(self) -> float:
        """Items dumped per minute [1/min]."""

    @property
    def cost_s(self) -> float:
        """Seconds plus the price of collision events; for each item where garbage keeps coming [s]."""


MissionRunner = Callable[
    [MissionConfig, StartConfiguration, int, Mapping[str, Mapping[str, float]], StrategySpec, tuple[Path, ...]],
    MissionOutcome,
]


@dataclass(frozen=True)
class RunTask:
    """What one run needs; plain data that travels to a worker process."""

    experiment: str
    scenario: str
    seed: int
    """Seed of the experiment; with `scenario` it gives the seed of the mission."""
    condition: str
    mission: MissionConfig
    start: StartConfiguration
    scores: Mapping[str, Mapping[str, float]]
    strategy: StrategySpec = BY_SCORE
    """What decides which options serve the goals."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations."""


@dataclass(frozen=True)
class RunRecord:
    """One finished run; collisions have one entry per collision distance."""

    experiment: str
    scenario: str
    seed: int
    condition: str
    completed: bool
    duration_s: float
    collision_samples_per_s: tuple[float, ...]
    collision_events_per_s: tuple[float, ...]
    garbage_done: int
    robots: int
    ticks: int
    items_per_min: float
    cost_s: float
    wall_s: float

    @classmethod
    def of(
        cls, outcome: MissionOutcome, experiment: str, scenario: str, seed: int, condition: str, wall: float
    ) -> "RunRecord":
        """Return the record of a mission's outcome, of which any number type becomes a plain one; `wall` in [s]."""
        return cls(
            experiment=experiment,
            scenario=scenario,
            seed=seed,
            condition=condition,
            completed=bool(outcome.completed),
            duration_s=float(outcome.duration_s),
            collision_samples_per_s=tuple(float(rate) for rate in outcome.collision_samples_per_s),
            collision_events_per_s=tuple(float(rate) for rate in outcome.collision_events_per_s),
            garbage_done=int(outcome.garbage_done),
            robots=int(outcome.robots),
            ticks=int(outcome.ticks),
            items_per_min=float(outcome.items_per_min),
            cost_s=float(outcome.cost_s),
            wall_s=round(wall, 3),
        )

    @property
    def key(self) -> tuple[str, str]:
        """Scenario and condition, unique within an experiment."""
        return self.scenario, self.condition


def tasks_of(experiment: ExperimentConfig, seed: int, directories: tuple[Path, ...] = ()) -> list[RunTask]:
    """Return every condition on every start configuration; a start that does not fit raises ConfigurationError."""
    missions = [for_start(experiment.mission, start) for start in experiment.starts]
    return [
        RunTask(
            experiment.name,
            start.id,
            seed,
            condition.name,
            mission,
            start,
            condition.scores,
            condition.strategy,
            directories,
        )
        for start, mission in zip(experiment.starts, missions, strict=True)
        for condition in experiment.conditions
    ]


def execute(task: RunTask, run_mission: MissionRunner) -> RunRecord:
    """Run one task in this process."""
    began = time.perf_counter()
    seed = run_seed(task.seed, task.scenario)
    result = run_mission(task.mission, task.start, seed, task.scores, task.strategy, task.directories)
    wall = time.perf_counter() - began
    return RunRecord.of(result, task.experiment, task.scenario, task.seed, task.condition, wall)


def execute_all(tasks: Sequence[RunTask], workers: int, run_mission: MissionRunner) -> Generator[RunRecord, None, None]:
    """Yield the record of each task as it is finished, in any order; see `processes.each_done`."""
    yield from each_done(partial(execute, run_mission=run_mission), tasks, workers)


def usable_cpus() -> int:
    """Return the number of CPUs that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
