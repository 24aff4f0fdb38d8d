"""The runs of a comparison as tables of figures, and what all reports on them have.

Shapes: S members of a condition (one for each seed of its training), K scenarios, V world seeds of each.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import items_keep_coming
from clean_swarm_env.deciders.named import FIXED
from clean_swarm_env.world.mission import MissionResult
from clean_swarm_env.world.task import Task, task_class
from selector.documents.trust import BASELINE
from selforg.arrays import Floats
from train.analysis.statistics import Summary, summarise
from train.analysis.task_report import MeasuredStrategy, measured_strategies
from train.running.runs import RunKey, RunRecord, under

Measured = Mapping[str, Mapping[str, Mapping[str, float | None]]]
"""Scenario -> name of a condition -> figure -> value."""
COST: Final = "cost_s"
METRICS: Final = ("duration_s", "collision_samples_per_s", "collision_events_per_s")
"""Figures of cleaning that are compared between the conditions of an experiment."""


def distance_metrics(distances: Sequence[float]) -> list[str]:
    """Return the names of the collision figures at each distance [m], samples first."""
    return [f"{kind}_per_s_at_{distance}m" for kind in ("samples", "events") for distance in distances]


def figures_of(mission: MissionConfig, result: MissionResult) -> dict[str, float]:
    """Return all figures of a run: those of any mission, collisions at each distance, and the measures of its task."""
    samples, events = result.collision_samples_per_s, result.collision_events_per_s
    return {
        "completed": float(result.completed),
        **dict(zip(METRICS, (result.duration_s, samples[0], events[0]), strict=True)),
        COST: result.cost_s,
        "excess_s": result.excess_s,
        "events": events[0] * result.ticks / mission.world.control_rate,
        "events_per_s": events[0],
        "contact_s": samples[0] * result.ticks / mission.world.control_rate / mission.world.physics_rate,
        "items": float(result.garbage_done),
        **dict(zip(distance_metrics(mission.counted_distances), (*samples, *events), strict=True)),
        **result.measures,
    }


@dataclass(frozen=True)
class Runs:
    """The runs of a comparison."""

    document: ExperimentConfig | FamilyConfig
    """What scenarios are drawn from."""
    goal: str
    """Goal that the strategies choose options for."""
    seed: int
    names: tuple[tuple[str, ...], ...]
    """Names (K, V) of the scenarios."""
    conditions: Mapping[str, tuple[str, ...]]
    """Label of a condition -> (S,) names under which the runs of its members are kept."""
    records: Sequence[RunRecord]
    """All runs in the directory, also those of conditions that are not compared."""
    baseline: str = BASELINE
    """Label of the condition under which the baseline of the task commands, if there is one."""

    @property
    def scenarios(self) -> int:
        """K."""
        return len(self.names)

    @property
    def fixed(self) -> tuple[str, ...]:
        """Labels of the strategies that are one option each."""
        return tuple(label for label in self.conditions if label.startswith(f"{FIXED}:"))

    @property
    def title(self) -> str:
        """The name, the number of scenarios and the seed, for figures."""
        return f"{self.document.name}: {self.scenarios} scenario{'s' * (self.scenarios > 1)}, seed {self.seed}"

    def titled(self, *, given: bool) -> str:
        """Return the same for tables, and whether the starts are given or drawn."""
        return f"{self.title}, {'given' if given else 'random'} starts"

    @property
    def task(self) -> type[Task[Any, Any]]:
        """The class of the task."""
        return task_class(self.document.mission)

    @cached_property
    def missions(self) -> list[MissionConfig]:
        """The missions (K,) of the scenarios."""
        return [self.document.scenario_named(self.seed, worlds[0]).mission for worlds in self.names]

    @cached_property
    def figures(self) -> dict[RunKey, dict[str, float]]:
        """Scenario and name of a run -> its figures."""
        return {record.key: figures_of(self.document.mission, record.result) for record in self.records}

    @cached_property
    def unfinished(self) -> dict[str, Floats]:
        """Label -> whether missions (S, K, V) were not completed, 1 or 0; nothing where items keep coming."""
        if items_keep_coming(self.missions[0]):
            return {}
        return {label: 1.0 - own for label, own in self.table("completed").items()}

    @property
    def censored(self) -> dict[str, Floats]:
        """The unfinished missions where a task has no measures: by these, costs are known however a mission ends."""
        return {} if self.task.measures else self.unfinished

    def within(self, variant: str) -> Runs:
        """Return the runs in a variant of the document."""
        named = {label: tuple(under(variant, own) for own in names) for label, names in self.conditions.items()}
        return replace(self, conditions=named)

    def table(self, figure: str) -> dict[str, Floats]:
        """Return label -> a figure (S, K, V) of all results."""
        at = self.figures
        return {
            label: np.array([[[at[name, own][figure] for name in worlds] for worlds in self.names] for own in names])
            for label, names in self.conditions.items()
        }

    def values(self, figure: str) -> dict[str, Floats]:
        """Return label -> the means (K,) of a figure in each scenario."""
        return {label: own.mean(axis=(0, 2)) for label, own in self.table(figure).items()}


@dataclass(frozen=True)
class Report(ABC):
    """What the report on an experiment and that on a family have."""

    runs: Runs

    @property
    @abstractmethod
    def summarised(self) -> Sequence[str]:
        """The figures of `summaries`."""

    @cached_property
    def summaries(self) -> dict[str, dict[str, Summary]]:
        """Label -> figure -> its summary over the scenarios."""
        tables = {figure: self.runs.values(figure) for figure in self.summarised}
        labels = self.runs.conditions
        return {label: {figure: summarise(own[label]) for figure, own in tables.items()} for label in labels}

    @property
    def summary(self) -> dict[str, dict[str, Any]]:
        """The summaries as plain data."""
        return {label: {name: asdict(one) for name, one in own.items()} for label, own in self.summaries.items()}

    @cached_property
    def measured(self) -> list[MeasuredStrategy]:
        """Measures of the task under each condition; empty for a task that has prices instead."""
        measures, runs = self.runs.task.measures, self.runs
        return measured_strategies(measures, {one.name: runs.table(one.name) for one in measures}, runs.baseline)
