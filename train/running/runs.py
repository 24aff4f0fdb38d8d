"""One run, which is a mission under one condition: its task for a worker process, and its record."""

import json
import os
import time
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Annotated, Any, Protocol

from pydantic import Field, TypeAdapter, ValidationError

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import for_start, run_seed
from clean_swarm_env.recording.recorder import RecordSettings, record_mission
from clean_swarm_env.world.mission import MissionResult, MissionRun, run_mission
from clean_swarm_env.world.task import measures_of
from selector.coordination.selection import BY_SCORE
from selector.documents.fields import LARGEST_NUMBER
from selector.strategies.registry import StrategySpec

WARM_UP_LIMIT = 300.0
"""Time limit of a mission that runs only to compile kernels [s]: by then robots have met and stores have grown."""

HIGHEST_SCORE = LARGEST_NUMBER
"""Score of an option that is to be taken, above all others."""

RunKey = tuple[str, str]
"""Scenario and condition."""
MissionRunner = Callable[
    [MissionConfig, StartConfiguration, int, Mapping[str, Mapping[str, float]], StrategySpec, tuple[Path, ...]],
    MissionResult,
]
"""A function that runs a mission, with the arguments of `run_mission`."""


@dataclass(frozen=True)
class RunRecord:
    """One finished run."""

    experiment: str
    """Name of the experiment or of the family."""
    scenario: str
    seed: int
    """Seed of the evaluation."""
    condition: str
    result: MissionResult
    wall_s: float
    """Time that the run took [s]."""
    counts: Mapping[str, Annotated[int, Field(ge=0)]] = field(default_factory=dict, kw_only=True)
    """How often a team that looked ahead took each alternative, or what a study counts; nothing in other runs."""

    @property
    def key(self) -> RunKey:
        """Scenario and condition, unique within an evaluation."""
        return self.scenario, self.condition

    def as_mapping(self) -> dict[str, Any]:
        """Return the record as a mapping with the keys `RUN_COLUMNS`, and `FURTHER` where there is something."""
        result = asdict(self.result)
        further = {MEASURES: result.pop(MEASURES), COUNTED: self.counts}
        own = {name: getattr(self, name) for name in NAMING}
        return {**own, **result, "wall_s": self.wall_s, **{name: value for name, value in further.items() if value}}

    @classmethod
    def of_mapping(cls, given: Mapping[str, Any]) -> "RunRecord":
        """Return the record of a mapping by `as_mapping`; ValueError for anything else."""
        if set(given) - set(FURTHER) != set(RUN_COLUMNS):
            raise ValueError(f"expected the keys {', '.join(RUN_COLUMNS)}")
        for name, value in given.items():
            for number in value if isinstance(value, list | tuple) else [value]:
                if isinstance(number, int | float) and not 0.0 <= number <= LARGEST_FIGURE:
                    raise ValueError(f"{name}: expected a number from 0 to {LARGEST_FIGURE:g}, got {number:g}")
        of_result = (*_RESULT_COLUMNS, MEASURES)
        result = {name: value for name, value in given.items() if name in of_result}
        own = {name: value for name, value in given.items() if name not in of_result}
        try:
            return _RECORD.validate_json(json.dumps({**own, "result": result}), strict=True)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            raise ValueError(f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from error

    def mistake(self, experiment: str, seed: int, mission: MissionConfig) -> str:
        """Return how the record shows that it is not of `mission` in an evaluation; empty if nothing shows it."""
        result = self.result
        limit = mission.time_limit * (1.0 + 1e-9)
        names = {measure.name for measure in measures_of(mission)}
        checks = (
            ("experiment", self.experiment == experiment, experiment, self.experiment),
            ("seed", self.seed == seed, seed, self.seed),
            ("duration_s", result.duration_s <= limit, f"at most {mission.time_limit:g}", result.duration_s),
            ("robots", result.robots <= mission.rows, f"at most {mission.rows}", result.robots),
            (MEASURES, set(result.measures) == names, ", ".join(sorted(names)) or "none", list(result.measures)),
            *(
                (
                    name,
                    len(given) == len(mission.collision_distances),
                    f"{len(mission.collision_distances)} numbers",
                    given,
                )
                for name, given in (
                    ("collision_samples_per_s", result.collision_samples_per_s),
                    ("collision_events_per_s", result.collision_events_per_s),
                )
            ),
        )
        return next(
            (f"{name}: expected {expected}, got {given}" for name, fits, expected, given in checks if not fits), ""
        )


LARGEST_FIGURE = 1e15
"""Largest figure of a run; a long mission in which many items are left costs much."""
NAMING = ("experiment", "scenario", "seed", "condition")
"""Columns that identify a run."""
MEASURES = "measures"
"""Key of the measures of a task in `runs.jsonl`; in `runs.csv` each has a column of its own name."""
COUNTED = "counts"
"""Key of the counts of a run."""
FURTHER = (MEASURES, COUNTED)
_RESULT_COLUMNS = tuple(column.name for column in fields(MissionResult) if column.name != MEASURES)
_RECORD = TypeAdapter(RunRecord)
RUN_COLUMNS = (*NAMING, *_RESULT_COLUMNS, "wall_s")
"""Columns of `runs.csv`, before those of measures."""


def under(variant: str, condition: str) -> str:
    """Return the name under which the runs of a condition are kept in a variant of a family, or a stage of a study."""
    return f"{variant} - {condition}" if variant else condition


class Work(Protocol):
    """Runs that one process does; plain data, which can be sent to a worker process."""

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """Scenario and condition of each run."""

    def without(self, done: Collection[RunKey]) -> "Work":
        """Return those runs that are not `done`, of which there is at least one."""

    def each(self) -> Iterator[RunRecord]:
        """Do the runs, and yield each when it is done."""


class Job(Work, Protocol):
    """Runs of an evaluation or a study that one process does."""

    def run(self) -> list[RunRecord]:
        """Do the runs, and return them in the order of the task."""

    def beginning(self) -> "Job":
        """Return a task that does only the beginning of one run, which compiles the kernels that all runs call."""

    def recorded(self, settings: RecordSettings) -> "Job":
        """Return a task that does the same runs and records each."""


@dataclass(frozen=True)
class RunTask:
    """One run of an experiment."""

    experiment: str
    scenario: str
    seed: int
    """Seed of the experiment; the seed of the mission follows from it and `scenario`."""
    condition: str
    mission: MissionConfig
    start: StartConfiguration
    scores: Mapping[str, Mapping[str, float]]
    """Goal -> option -> score, in place of scores of the expert knowledge."""
    strategy: StrategySpec
    """Strategy that chooses the options."""
    directories: tuple[Path, ...]
    """The user's own directories of configurations."""
    run_mission: MissionRunner
    """Function that runs the mission."""
    record: RecordSettings | None = None
    """Where the mission is recorded; it is not unless given."""

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """Scenario and condition."""
        return ((self.scenario, self.condition),)

    def without(self, done: Collection[RunKey]) -> "RunTask":
        """Return this one run."""
        return self

    @property
    def mission_seed(self) -> int:
        """Seed of everything random in the mission."""
        return run_seed(self.seed, self.scenario)

    @property
    def naming(self) -> dict[str, Any]:
        """Plain data about the run for the head of its recording."""
        return {"experiment": self.experiment, "scenario": self.scenario, "condition": self.condition}

    def each(self) -> Iterator[RunRecord]:
        """Run the mission."""
        yield from self.run()

    def run(self) -> list[RunRecord]:
        """Run the mission."""
        began = time.perf_counter()
        run = MissionRun(self.mission, self.start, self.mission_seed, self.scores, self.strategy, self.directories)
        if self.record is not None:
            result = record_mission(run, self.record, self.naming)
        else:
            result = self.run_mission(run.mission, run.start, run.seed, run.scores, run.strategy, run.directories)
        wall = round(time.perf_counter() - began, 3)
        return [RunRecord(self.experiment, self.scenario, self.seed, self.condition, result, wall)]

    def knowing(self, learned: Mapping[str, Any]) -> "RunTask":
        """Return the run with the learned rewards of a manifest at its beginning."""
        return replace(self, mission=self.mission.beginning_with(learned))

    def serving(self, options: Mapping[str, str]) -> "RunTask":
        """Return the run in which `options` serve their goals all the time; goal -> option."""
        return replace(self, scores=forcing(options), strategy=BY_SCORE)

    def beginning(self) -> "RunTask":
        """Return the run up to `WARM_UP_LIMIT`."""
        limit = min(self.mission.time_limit, WARM_UP_LIMIT)
        return replace(self, mission=self.mission.model_copy(update={"time_limit": limit}), record=None)

    def recorded(self, settings: RecordSettings) -> "RunTask":
        """Return the run with a recording."""
        return replace(self, record=settings)


def forcing(options: Mapping[str, str]) -> dict[str, dict[str, float]]:
    """Return scores by which `options` serve their goals; goal -> option."""
    return {goal: {option: HIGHEST_SCORE} for goal, option in options.items()}


def tasks_of(experiment: ExperimentConfig, seed: int, directories: tuple[Path, ...] = ()) -> list[RunTask]:
    """Return a task for every condition on every start; ConfigurationError for a start that does not fit.

    Where a machine or policy decides for its own goal, options of the highest score serve the others.
    """
    missions = [for_start(experiment.mission, start) for start in experiment.starts]
    return [
        RunTask(
            experiment=experiment.name,
            scenario=start.id,
            seed=seed,
            condition=condition.name,
            mission=mission,
            start=start,
            scores=condition.scores,
            strategy=condition.deciders[0],
            directories=directories,
            run_mission=run_mission,
        )
        for start, mission in zip(experiment.starts, missions, strict=True)
        for condition in experiment.conditions
    ]


def usable_cpus() -> int:
    """Return the number of CPUs that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
