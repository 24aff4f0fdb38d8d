"""Tasks of an evaluation on a family: scenarios that one process does in one batch."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from clean_swarm_env.config.families import FamilyConfig, Scenario, Split, scenario_name
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.errors import DocumentError
from selector.documents.plain import short
from selector.strategies.problem import Problem
from selforg.arrays import Ints
from train.evaluation.entrants import FIXED, action_of, any_pilot
from train.running.finished_runs import natural_order
from train.running.pilots import AnyPilot
from train.running.runs import WARM_UP_LIMIT, RunKey, RunRecord
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
        record = self.record and replace(self.record, about=self.naming)
        settings = TrialSettings(self.goal, TASK_SCENARIOS, self.observation, self.directories, record, self.action)
        for place, result in each_trial(scenarios, self.pilot, settings):
            before, began = time.perf_counter(), before
            wall = round(before - began, 3)
            yield RunRecord(self.family.name, scenarios[place].id, self.seed, self.condition, result, wall)

    def knowing(self, learned: Mapping[str, Any]) -> TrialTask:
        """Return the runs that begin with what was learned of options, as a manifest holds it."""
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
    def action(self) -> ActionConfig:
        """What the member gives: options, movement vectors or both."""
        return action_of(self.member, self.directories)

    @property
    def observation(self) -> ObservationConfig:
        """What the member sees."""
        return ObservationConfig.usual(self.family.terms, steered=self.action.mode == "velocity")

    def pilot(self, problem: Problem, teams: Ints) -> AnyPilot:
        """Return the pilot of the member."""
        return any_pilot(self.member, problem, teams, self.directories)
