"""Runs, which are missions under one condition: their records, and what does them."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Annotated, Any, Protocol

from pydantic import Field, TypeAdapter, ValidationError

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.task import task_class

RunKey = tuple[str, str]
"""Scenario and condition."""


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
    """What an advice counts; nothing in other runs."""

    @property
    def key(self) -> RunKey:
        """Scenario and condition, unique within an evaluation."""
        return self.scenario, self.condition

    def as_mapping(self) -> dict[str, Any]:
        """Return the record as a mapping with the keys `RUN_COLUMNS`, and measures and counts where there are any."""
        result = asdict(self.result)
        further = {MEASURES: result.pop(MEASURES), COUNTED: self.counts}
        own = {name: getattr(self, name) for name in NAMING}
        return {**own, **result, "wall_s": self.wall_s, **{name: value for name, value in further.items() if value}}

    @classmethod
    def of_mapping(cls, given: Mapping[str, Any]) -> RunRecord:
        """Return the record of a mapping by `as_mapping`; ValueError for anything else."""
        if set(given) - {MEASURES, COUNTED} != set(RUN_COLUMNS):
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
        names = {measure.name for measure in task_class(mission).measures}
        checks = (
            ("experiment", self.experiment == experiment, experiment, self.experiment),
            ("seed", self.seed == seed, seed, self.seed),
            ("duration_s", result.duration_s <= limit, f"at most {mission.time_limit:g}", result.duration_s),
            ("robots", result.robots <= mission.rows, f"at most {mission.rows}", result.robots),
            (MEASURES, set(result.measures) == names, ", ".join(sorted(names)) or "none", list(result.measures)),
            *(
                (
                    name,
                    len(given) == len(mission.counted_distances),
                    f"{len(mission.counted_distances)} numbers",
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
_RESULT_COLUMNS = tuple(column.name for column in fields(MissionResult) if column.name != MEASURES)
_RECORD = TypeAdapter(RunRecord)
RUN_COLUMNS = (*NAMING, *_RESULT_COLUMNS, "wall_s")
"""Columns of `runs.csv`, before those of measures."""


def under(variant: str, condition: str) -> str:
    """Return the name under which the runs of a condition are kept in a variant of a family."""
    return f"{variant} - {condition}" if variant else condition


class Work(Protocol):
    """Runs that one process does; plain data, which can be sent to a worker process."""

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """Scenario and condition of each run."""

    def without(self, done: Collection[RunKey]) -> Work:
        """Return those runs that are not `done`, of which there is at least one."""

    def each(self) -> Iterator[Any]:
        """Do the runs, and yield each when it is done: a record, or something else with a `key`."""
