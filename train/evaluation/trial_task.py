"""Tasks of an evaluation on a family: scenarios that one process does in one batch."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import FamilyConfig, RobustnessConfig, Scenario, Split, place_of
from clean_swarm_env.config.starts import for_start, run_seed
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import usual_terms
from clean_swarm_env.world.mission import run_mission
from selector.documents.errors import DocumentError
from selector.documents.plain import short
from selector.strategies.problem import Problem
from selforg.arrays import Ints
from train.deciders.decided_goal import DecidedGoal
from train.deciders.decider import Decider
from train.deciders.named import FIXED, NamedDecider, decider_named
from train.running.runs import Job, RunRecord, RunTask
from train.running.trials import TrialSettings, each_trial

TASK_SCENARIOS = 25
"""Scenarios of one task, which run at the same time in one batch."""


@dataclass(frozen=True)
class TrialTask(Job):
    """Scenarios under one member of an entrant, or under the decider of a condition."""

    member: str
    goal: str = ""
    """Goal whose options it chooses; empty: the goals that it was made for."""

    def each(self) -> Iterator[RunRecord]:
        """Run the scenarios in one batch, and yield each run when it is done; its time is that since the one before."""
        before = time.perf_counter()
        known = {self.condition: self.named.network} if self.named.network else {}
        record = self.record and replace(self.record, about=self.naming, policies=known)
        settings = replace(self.settings, record=record)
        for place, result in each_trial(self.scenarios, self.decider, settings):
            before, began = time.perf_counter(), before
            scenario = self.scenarios[place]
            yield self.finished(scenario, result, before - began)

    def serving(self, options: Mapping[str, str]) -> TrialTask:
        """Return the runs under the option of the goal."""
        if self.goal not in options:
            raise DocumentError(f"expected an option of {self.goal}, got {short(options)}")
        return replace(self, member=f"{FIXED}:{options[self.goal]}")

    @cached_property
    def named(self) -> NamedDecider:
        """The member, as its text names it."""
        return decider_named(self.member, self.directories)

    @property
    def settings(self) -> TrialSettings:
        """What the member decides on, sees and gives."""
        named = self.named
        seen, action = named.observation(usual_terms(self.first.mission)), ActionConfig(mode=named.mode)
        return TrialSettings(named.decides(self.goal), TASK_SCENARIOS, seen, self.directories, self.record, action)

    def decider(self, problem: Problem, teams: Ints) -> Decider:
        """Return the decider of the member."""
        return self.named.build(problem, teams)

    def team(self, **settings: Any) -> tuple[Batch, DecidedGoal, Decider]:  # noqa: ANN401  (those of Batch)
        """Return a world, what is decided in it, and the decider; an error of one line if they do not fit."""
        own = self.settings
        batch = Batch(
            self.first.mission,
            directories=self.directories,
            observation=own.observation,
            action=own.action,
            **settings,
        )
        decided = DecidedGoal(batch, own.goal)
        decider = self.decider(decided.problem, np.zeros(batch.rows, dtype=np.int64))
        decided.check(decider)
        return batch, decided, decider


def scenario_named(family: FamilyConfig, seed: int, name: str) -> Scenario:
    """Return the scenario of a family with a name such as `test-3`; DocumentError if there is none."""
    index, world = place_of(name)
    split: Split = "train" if name.startswith("train") else "test"
    return family.scenario(seed, index, split, world)


def experiment_tasks(
    experiment: ExperimentConfig, seed: int, directories: tuple[Path, ...] = ()
) -> list[RunTask | TrialTask]:
    """Return a task for every condition on every start; ConfigurationError for a start that does not fit.

    Where a machine or policy decides for its own goal, options of the highest score serve the others.
    """
    found: list[RunTask | TrialTask] = []
    for start in experiment.starts:
        scenario = Scenario(start.id, run_seed(seed, start.id), for_start(experiment.mission, start), start)
        for condition in experiment.conditions:
            strategy, member = condition.deciders
            named = (experiment.name, seed, (scenario,), condition.name)
            if member:
                found.append(TrialTask(*named, member, directories=directories))
            else:
                given = (condition.scores, strategy, run_mission)
                found.append(RunTask(*named, *given, directories=directories))
    return found


def variants_of(family: FamilyConfig) -> Mapping[str, FamilyConfig]:
    """Return the families under which strategies run, by name: with each disturbance, or only itself without a name."""
    return family.disturbed if isinstance(family, RobustnessConfig) else {"": family}
