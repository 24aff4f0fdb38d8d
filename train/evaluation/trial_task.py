"""Tasks of an evaluation on a family: scenarios that one process does in one batch."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import FamilyConfig, Scenario, Split, scenario_name
from clean_swarm_env.config.load import random_starts
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import run_seed
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.errors import DocumentError, validated
from selector.documents.plain import short
from selector.strategies.problem import Problem
from selforg.arrays import Ints
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import Decider
from train.deciders.named import FIXED, NamedDecider, decider_named
from train.running.finished_runs import natural_order
from train.running.runs import WARM_UP_LIMIT, RunKey, RunRecord, RunTask, tasks_of
from train.running.trials import TrialSettings, each_trial

TASK_SCENARIOS = 25
"""Scenarios of one task, which run at the same time in one batch."""


@dataclass(frozen=True)
class TrialTask:
    """Some scenarios of a family under one member of an entrant; plain data, which can be sent to a worker process."""

    family: FamilyConfig
    seed: int
    places: tuple[tuple[int, int], ...]
    """Index and world of each scenario, from 0 on."""
    condition: str
    member: str
    goal: str
    directories: tuple[Path, ...]
    time_limit: float = math.inf
    """Limit of simulated time in addition to that of the mission [s]."""
    record: RecordSettings | None = None
    """Where the missions are recorded; none is unless given."""
    split: Split = "test"

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """Scenario and condition of each run."""
        return tuple((scenario_name(self.split, *place), self.condition) for place in self.places)

    def without(self, done: Collection[RunKey]) -> TrialTask:
        """Return the task of the scenarios that are not `done`."""
        keys = zip(self.places, self.keys, strict=True)
        return replace(self, places=tuple(place for place, key in keys if key not in done))

    @property
    def experiment(self) -> str:
        """Name of the family."""
        return self.family.name

    @property
    def scenario(self) -> str:
        """Name of the first scenario."""
        return self.scenario_of(self.places[0]).id

    @property
    def mission(self) -> MissionConfig:
        """Mission of the first scenario."""
        return self.scenario_of(self.places[0]).mission

    @property
    def start(self) -> StartConfiguration:
        """Start of the first mission."""
        return self.scenario_of(self.places[0]).start

    @property
    def mission_seed(self) -> int:
        """Seed of the first mission."""
        return self.scenario_of(self.places[0]).seed

    def run(self) -> list[RunRecord]:
        """Run the scenarios in one batch, and return their runs in the order of the scenarios."""
        return sorted(self.each(), key=lambda record: natural_order(record.scenario))

    def each(self) -> Iterator[RunRecord]:
        """Run the scenarios in one batch, and yield each run when it is done; its time is that since the one before."""
        before = time.perf_counter()
        scenarios = [self.scenario_of(place) for place in self.places]
        settings = replace(self.settings, record=self.record and replace(self.record, about=self.naming))
        for place, result in each_trial(scenarios, self.decider, settings):
            before, began = time.perf_counter(), before
            wall = round(before - began, 3)
            run = (self.family.name, scenarios[place].id, self.seed, self.condition, result, wall)
            yield RunRecord(*run, counts=self.counts(scenarios[place]))

    def counts(self, scenario: Scenario) -> Mapping[str, int]:
        """Return the counts of a mission; see `RunRecord`."""
        return {}

    def knowing(self, learned: Mapping[str, Any]) -> TrialTask:
        """Return the runs with the learned rewards of a manifest at their beginning."""
        mission = self.family.mission.beginning_with(learned)
        return replace(self, family=self.family.model_copy(update={"mission": mission}))

    def serving(self, options: Mapping[str, str]) -> TrialTask:
        """Return the runs in which an option serves the goal all the time; goal -> option."""
        if self.goal not in options:
            raise DocumentError(f"expected an option of {self.goal}, got {short(options)}")
        return replace(self, member=f"{FIXED}:{options[self.goal]}")

    def beginning(self) -> TrialTask:
        """Return the first scenario up to `WARM_UP_LIMIT`."""
        return replace(self, places=self.places[:1], time_limit=WARM_UP_LIMIT, record=None)

    def recorded(self, settings: RecordSettings) -> TrialTask:
        """Return the runs with recordings."""
        return replace(self, record=settings)

    @property
    def naming(self) -> dict[str, str]:
        """Plain data about the runs for the heads of their recordings."""
        return {"experiment": self.family.name, "condition": self.condition}

    def scenario_of(self, place: tuple[int, int]) -> Scenario:
        """Return the scenario of an index and a world."""
        scenario = self.family.scenario(self.seed, place[0], self.split, place[1])
        limit = min(scenario.mission.time_limit, self.time_limit)
        return replace(scenario, mission=scenario.mission.model_copy(update={"time_limit": limit}))

    @cached_property
    def named(self) -> NamedDecider:
        """The member, as its text names it."""
        return decider_named(self.member, self.directories)

    @property
    def settings(self) -> TrialSettings:
        """What the member decides on, sees and gives."""
        seen, action = self.named.observation(self.family.mission.terms), ActionConfig(mode=self.named.mode)
        goal = self.named.goal or self.goal
        return TrialSettings(goal, TASK_SCENARIOS, seen, self.directories, self.record, action)

    def decider(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider of the member."""
        return self.named.build(problem, teams)


@dataclass(frozen=True)
class StartTask(TrialTask):
    """One start configuration of an experiment under a decider that is no strategy of all goals."""

    given: StartConfiguration = field(kw_only=True)

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """Scenario and condition of the run."""
        return ((self.given.id, self.condition),)

    def scenario_of(self, place: tuple[int, int]) -> Scenario:
        """Return the mission on the start configuration."""
        mission = self.family.mission
        mission = mission.model_copy(update={"time_limit": min(mission.time_limit, self.time_limit)})
        return Scenario(self.given.id, run_seed(self.seed, self.given.id), mission, self.given)

    @property
    def settings(self) -> TrialSettings:
        """What the member decides on, sees and gives."""
        return replace(super().settings, goal=self.named.meant_for or None)

    def check(self) -> None:
        """Raise an error of one line for a decider that does not fit the mission."""
        settings = self.settings
        batch = Batch(
            self.mission, directories=self.directories, observation=settings.observation, action=settings.action
        )
        decided = DecidedGoal(batch, settings.goal)
        decided.check(self.decider(decided.problem, np.zeros(batch.rows, dtype=np.int64)))


def experiment_tasks(
    experiment: ExperimentConfig, seed: int, directories: tuple[Path, ...] = ()
) -> list[RunTask | TrialTask]:
    """Return a task for every condition on every start; ConfigurationError for a start that does not fit."""
    members = {each.name: own for each in experiment.conditions if (own := each.deciders[1])}

    def task(run: RunTask) -> RunTask | TrialTask:
        if run.condition not in members:
            return run
        named = {"name": experiment.name, "description": experiment.description}
        family = random_starts(run.mission).model_copy(update=named)
        member = members[run.condition]
        return StartTask(family, seed, ((0, 0),), run.condition, member, "", directories, given=run.start)

    return [task(run) for run in tasks_of(experiment, seed, directories)]


def identities(tasks: Sequence[RunTask | TrialTask]) -> dict[str, str]:
    """Return the identity of the decider of each condition that has one."""
    return {task.condition: task.named.identity for task in tasks if isinstance(task, TrialTask)}


def with_periods(family: FamilyConfig, periods: Sequence[float]) -> dict[str, FamilyConfig]:
    """Return the family with decision periods [s] of other lengths, by name; DocumentError for one that cannot be."""
    found = {}
    for period in periods:
        changed = {**family.mission.model_dump(), "decision_period": period}
        mission = validated(MissionConfig, changed, "--period", own=True)
        found[f"{period:g} s"] = family.model_copy(update={"mission": mission})
    return found
