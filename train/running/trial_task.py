"""Tasks of an evaluation: scenarios under one condition, which one process does in one batch."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.decider import Decider
from clean_swarm_env.deciders.named import FIXED, NamedDecider, decider_named
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import usual_terms
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.world.mission import MissionResult
from selector.documents.errors import DocumentError
from selector.documents.plain import short
from selector.strategies.problem import Problem
from selforg.arrays import Ints
from train.running.runs import RunKey, RunRecord
from train.running.trials import TrialSettings, each_trial

TASK_SCENARIOS = 25
"""Scenarios of one task, which run at the same time in one batch."""
WARM_UP_LIMIT = 300.0
"""Time limit of a mission that runs only to compile kernels [s]: by then robots have met and stores have grown."""


@dataclass(frozen=True)
class TrialTask:
    """Scenarios under one decider; plain data, which can be sent to a worker process."""

    experiment: str
    """Name of the experiment or of the family."""
    seed: int
    """Seed of the evaluation."""
    scenarios: tuple[Scenario, ...]
    condition: str
    member: str
    """What decides, as `decider_named` takes it."""
    goal: str = ""
    """Goal whose options it chooses; empty: the goals that it was made for."""
    directories: tuple[Path, ...] = field(default=(), kw_only=True)
    """The user's own directories of configurations."""
    record: RecordSettings | None = field(default=None, kw_only=True)
    """Where the missions are recorded; none is unless given."""

    @property
    def keys(self) -> tuple[RunKey, ...]:
        """Scenario and condition of each run."""
        return tuple((scenario.id, self.condition) for scenario in self.scenarios)

    @property
    def first(self) -> Scenario:
        """The first scenario."""
        return self.scenarios[0]

    def run(self) -> list[RunRecord]:
        """Do the runs, and return them in the order of the scenarios."""
        return sorted(self.each(), key=lambda record: self.keys.index(record.key))

    def without(self, done: Collection[RunKey]) -> TrialTask:
        """Return the runs that are not `done`."""
        left = tuple(scenario for scenario in self.scenarios if (scenario.id, self.condition) not in done)
        return replace(self, scenarios=left)

    def beginning(self, seconds: float = WARM_UP_LIMIT) -> TrialTask:
        """Return the beginning of the first run, which compiles the kernels that all runs call."""
        limit = min(self.first.mission.time_limit, seconds)
        short = self.first.mission.model_copy(update={"time_limit": limit})
        return replace(self, scenarios=(replace(self.first, mission=short),), record=None)

    def knowing(self, learned: Mapping[str, Any]) -> TrialTask:
        """Return the runs with the learned rewards of a manifest at their beginning."""
        known = [replace(each, mission=each.mission.beginning_with(learned)) for each in self.scenarios]
        return replace(self, scenarios=tuple(known))

    def each(self) -> Iterator[RunRecord]:
        """Run the scenarios in one batch, and yield each run when it is done; its time is that since the one before."""
        before = time.perf_counter()
        for place, result in each_trial(self.scenarios, self.decider, self.settings):
            before, began = time.perf_counter(), before
            yield self.finished(self.scenarios[place], result, before - began)

    def finished(self, scenario: Scenario, result: MissionResult, seconds: float, **more: Any) -> RunRecord:  # noqa: ANN401
        """Return the record of a run; `seconds` is the time that it took."""
        wall = round(seconds, 3)
        return RunRecord(self.experiment, scenario.id, self.seed, self.condition, result, wall, **more)

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
        return TrialSettings(named.decides(self.goal), TASK_SCENARIOS, seen, self.directories, self.recording, action)

    @property
    def recording(self) -> RecordSettings | None:
        """Where and how the missions are recorded, if they are."""
        known = {self.condition: self.named.network} if self.named.network else {}
        about, thinking = {"experiment": self.experiment, "condition": self.condition}, self.named.mode != "velocity"
        return self.record and replace(self.record, about=about, policies=known, thinking=thinking)

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
            record=own.record,
            **settings,
        )
        decided = DecidedGoal(batch, own.goal)
        decider = self.decider(decided.problem, np.zeros(batch.rows, dtype=np.int64))
        decided.check(decider)
        return batch, decided, decider

    def parts(self) -> list[TrialTask]:
        """Return the runs in tasks of at most `TASK_SCENARIOS`."""
        firsts = range(0, len(self.scenarios), TASK_SCENARIOS)
        return [replace(self, scenarios=self.scenarios[first : first + TASK_SCENARIOS]) for first in firsts]
