"""`clean-swarm run`: a task by one option and by its baseline from the same starts; an evaluation without files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import own_mission, random_starts
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.task_names import OWN_TASK, task_names
from clean_swarm_env.config.tasks import find_task, with_changes
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.config.world import GroundKind
from clean_swarm_env.world.task import coordinators_of
from selector.configurations.library import library_of
from selector.documents.errors import validated
from selector.documents.trust import BASELINE, is_import
from selector.knowledge import unknown_option
from selector.strategies.unlearned import MaxScore
from selforg.registry import unknown
from train.analysis.family_report import FamilyRuns, family_report_of
from train.analysis.task_report import MeasuredStrategy
from train.deciders.named import FIXED
from train.evaluation.family import AloneEvaluation
from train.evaluation.trial_task import TrialTask
from train.reports.task_tables import MEASURE_HEADS, measure_cells
from train.reports.text_table import Grid
from train.request import Request
from train.running.commands import progress
from train.running.engine import in_turn

USUAL_RUNS = 20
"""Runs of a task, unless a number is given."""


@dataclass(frozen=True)
class TaskRun(Request):
    """The request of a task beside its baseline; where a field is None, the task's own mission has the value."""

    option: str | None = None
    """Name of the option that serves its goal; the one of the highest score unless given."""
    robots: int | None = None
    """Number of robots."""
    seconds: float | None = None
    """Simulated time [s]."""
    ground: GroundKind | None = None
    """Kind of ground."""

    @property
    def runs(self) -> int:
        """Number of runs, each from a start of its own."""
        return self.scenarios or USUAL_RUNS

    @cached_property
    def own_mission(self) -> MissionConfig:
        """The mission for which the targets are stated."""
        return own_mission(self.name)

    @cached_property
    def mission(self) -> MissionConfig:
        """The mission with the changes of the request."""
        given = {
            "robots": {"count": self.robots},
            "world": {"ground": self.ground},
            "time_limit": self.seconds,
            "knowledge": self.knowledge,
        }
        own = self.own_mission.model_dump()
        return validated(MissionConfig, with_changes(own, _without_none(given)), self.name, own=True)


def _without_none(given: dict[str, Any]) -> dict[str, Any]:
    parts = {key: _without_none(value) if isinstance(value, dict) else value for key, value in given.items()}
    return {key: value for key, value in parts.items() if value is not None}


@dataclass(frozen=True)
class TaskOutcome:
    """The result of running a task."""

    request: TaskRun
    option: str
    measured: Sequence[MeasuredStrategy]
    """Measures of the option."""

    @property
    def task(self) -> Any:  # noqa: ANN401  (a class of tasks)
        """The task."""
        return find_task(self.request.name)

    @property
    def own_setting(self) -> bool:
        """Whether the mission is the one for which the targets are stated."""
        return setting_of(self.request.mission) == setting_of(self.request.own_mission)

    @property
    def reached(self) -> bool:
        """Whether every target is met and every baseline that is to be beaten is."""
        return all(one.met and one.beats is not False for one in self.measured)

    @property
    def content(self) -> dict[str, Any]:
        """Plain data for JSON."""
        mission = self.request.mission
        return {
            "task": self.request.name,
            "option": self.option,
            "story": self.task.story,
            "baseline": self.task.baseline,
            "robots": mission.robots.count,
            "seconds": mission.time_limit,
            "ground": mission.world.ground,
            "seed": self.request.seed,
            "runs": self.request.runs,
            "targets_are_for_this_setting": self.own_setting,
            "reached": self.reached,
            "measures": [one.content for one in self.measured],
        }


def setting_of(mission: MissionConfig) -> str:
    """Return what users choose of a mission, in words."""
    return f"{mission.robots.count} robots, {mission.time_limit:g} s, {mission.world.ground}"


def tasks_to_run() -> list[str]:
    """Return the names of all tasks that have a baseline."""
    kinds: dict[str, Any] = {name: find_task(name) for name in task_names()}
    return [name for name, kind in kinds.items() if kind.baseline]


def run_task(request: TaskRun) -> TaskOutcome:
    """Run a task by an option and by its baseline.

    Raises:
        ConfigurationError: task, option or setting do not exist or fit.

    """
    if is_import(request.name):
        request = replace(request, name=find_task(request.name).name)
    if request.name not in tasks_to_run():
        raise ConfigurationError(unknown("task with a baseline", request.name, tasks_to_run()) + OWN_TASK)
    mission = request.mission
    goal, option = _taken(request, mission)
    family, names = random_starts(mission), (f"{FIXED}:{option}", BASELINE)
    of_baseline = mission.model_copy(update={"knowledge": request.own_mission.knowledge})  # which has the baseline
    tasks = _tasks(request, family, names[0]) + _tasks(request, random_starts(of_baseline), BASELINE)
    if request.record is not None:
        tasks = [task.recorded(request.record) for task in tasks]
    records = []
    with progress(request.name, 2 * request.runs) as update:
        update(most=2 * request.runs * mission.time_limit)
        for record in in_turn(tasks):
            records.append(record)
            update(advance=1)
    conditions = {name: (name,) for name in names}
    report = family_report_of(FamilyRuns(family, goal, request.seed, request.runs, 1, conditions, (), records))
    measured = [one for one in report.measured if one.strategy != BASELINE]
    return TaskOutcome(request, option, measured)


def _tasks(request: TaskRun, family: FamilyConfig, strategy: str) -> list[TrialTask]:
    """Return the runs of a strategy."""
    asked = Request(request.name, (strategy,), request.seed, request.runs, directories=request.directories)
    return AloneEvaluation(asked, family).tasks({})


def _taken(request: TaskRun, mission: MissionConfig) -> tuple[str, str]:
    """Return the goal of the task, and the option that serves it: the given one, or that of the highest score."""
    known, library = knowledge_of(mission, request.directories), library_of(request.directories)
    model = coordinators_of(mission, known, library, request.directories)[0]
    if request.option is None:
        best = MaxScore(model.problem, np.zeros(1, dtype=np.uint64)).select(np.zeros((1, 0)))[0]
        return model.goal, model.options[best]
    if request.option not in model.options:
        raise ConfigurationError(f"goal {model.goal}: {unknown_option(model.goal, request.option, model.options)}")
    return model.goal, request.option


def outcome_grid(outcome: TaskOutcome) -> Grid:
    """Return the results of one task that was run."""
    request, task = outcome.request, outcome.task
    told = f"{request.runs} run{'s' * (request.runs > 1)} of seed {request.seed}"
    title = f"{request.name} by {outcome.option}: {setting_of(request.mission)}, {told}"
    rows = [measure_cells(one) for one in outcome.measured]
    notes = [f"baseline: {task.baseline}"]
    notes += [f"target of {one.measure.name}: {one.measure.reason}" for one in outcome.measured]
    if not outcome.own_setting:
        notes.append(f"targets are stated for {setting_of(request.own_mission)}")
    return Grid(title, MEASURE_HEADS, rows, notes=tuple(notes))
