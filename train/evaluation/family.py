"""The evaluation of strategies on a family of scenarios; all strategies get the same scenarios."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario, Split, place_of, scenario_name
from clean_swarm_env.config.known import knowledge_of, mission_context
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.errors import DocumentError, within
from selector.documents.plain import short
from selector.strategies.problem import Problem
from selector.strategies.streams import row_keys
from selforg.arrays import Ints
from train.analysis.family_report import FamilyRuns, family_report_of, family_summary_json
from train.evaluation.base import Choosers, Evaluation
from train.evaluation.entrants import (
    FIXED,
    any_pilot,
    check_fit,
    entrants_of,
    identified,
    mode_of,
    spec_of,
    with_baselines,
)
from train.knowledge_store import NO_STORE, StoreRequest, as_plain
from train.reports.family_figure import draw_front
from train.reports.family_tables import family_tables
from train.reports.write_report import Publication
from train.running.decided_goal import DecidedGoal
from train.running.finished_runs import natural_order
from train.running.needs import ALONE, Machine, Workload, check_needs
from train.running.pilots import AnyPilot
from train.running.provenance import fingerprints, versions
from train.running.run_folder import LEARNED_BEFORE
from train.running.runs import WARM_UP_LIMIT, RunKey, RunRecord
from train.running.trials import TrialSettings, each_trial

TASK_SCENARIOS = 25
"""Scenarios of one task, which run at the same time in one batch."""


@dataclass(frozen=True)
class FamilyRequest:
    """The request of the user."""

    family: str
    """Name of a family, or path to its YAML file."""
    strategies: tuple[str, ...]
    """Strategies to compare; see `entrants_of`."""
    seed: int
    scenarios: int | None = None
    """Number of scenarios, in place of the family's own."""
    knowledge: str | None = None
    """Expert knowledge in place of the family's own."""
    goal: str | None = None
    """Goal that the strategies choose options for; see `DecidedGoal`."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""
    store: StoreRequest = NO_STORE
    """The knowledge store."""
    scoring: bool = False
    """Whether the strategies are fixed options, each of which is scored."""
    machine: Machine = ALONE
    """What the evaluation may use."""
    worlds: int = 1
    """World seeds of each scenario."""

    @property
    def words(self) -> list[str]:
        """The command for this request."""
        if self.scoring:
            words = ["clean-swarm", "score", self.family, "--seed", str(self.seed)]
            words += [word for word in self.store.words if word != "--learn"]
        else:
            words = ["clean-swarm", "evaluate", "--family", self.family, "--seed", str(self.seed), *self.store.words]
            words += [word for text in self.strategies for word in ("--strategy", text)]
        words += ["--scenarios", str(self.scenarios)] if self.scenarios is not None else []
        words += ["--world-seeds", str(self.worlds)] if self.worlds > 1 else []
        words += ["--knowledge", self.knowledge] if self.knowledge is not None else []
        words += ["--goal", self.goal] if self.goal is not None and not self.scoring else []
        words += ["--force"] if self.machine.forced else []
        return words + [word for path in self.directories for word in ("--configs", str(path))]


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

    @property
    def action(self) -> ActionConfig:
        """What the member gives: options, movement vectors or both."""
        return ActionConfig(mode=mode_of(self.member, self.directories))

    @property
    def observation(self) -> ObservationConfig:
        """What the member sees."""
        return ObservationConfig.usual(self.family.terms, steered=self.action.mode == "velocity")

    def pilot(self, problem: Problem, teams: Ints) -> AnyPilot:
        """Return the pilot of the member."""
        return any_pilot(self.member, problem, teams, self.directories)


class FamilyEvaluation(Evaluation):
    """Strategies on the scenarios of a family; other strategies and scenarios can be added later."""

    growing = "strategies"

    def __init__(self, request: FamilyRequest, family: FamilyConfig | None = None) -> None:
        self._request, self.words = request, request.words
        self.directories = tuple(path.resolve() for path in request.directories)
        self.family = family or _family(request)
        with within(request.family):
            missions = (request.scenarios or self.family.scenarios) * request.worlds * len(request.strategies)
            check_needs(Workload(self.family.largest, missions, min(TASK_SCENARIOS, missions)), request.machine)
        self.mission = self.family.mission.model_copy(update={"store": ""})
        first = self.family.model_copy(update={"mission": self.mission}).scenario(0, 0, "test").mission
        batch = Batch(first, observation=ObservationConfig.usual(self.family.terms), directories=request.directories)
        problem = DecidedGoal(batch, request.goal).problem
        self.goal, self.options = problem.goal, problem.options
        self.entrants = entrants_of(request.strategies, problem.options)
        if not (request.scoring or request.store.learn):
            self.entrants = with_baselines(self.entrants, problem.options)
        check_fit(self.entrants, batch, self.family.terms, problem, request.directories)
        indices = range(request.scenarios or self.family.scenarios)
        self.scenarios = [scenario_name("test", k, world) for k in indices for world in range(request.worlds)]
        self.stem = f"{self.family.name}-seed{request.seed}"
        fixed = {f"{FIXED}:{option}": {self.goal: option} for option in problem.options}
        self.scored = fixed if request.scoring else {}
        store = replace(request.store, url=request.store.url or self.family.mission.store or None)
        if store.learn and not self.scored:
            self.choosers()  # a strategy that cannot choose for a whole mission is an error
        source = f"family {self.family.name}, {self.goal}, seed {request.seed}"
        known = knowledge_of(self.mission, request.directories)
        self.memory = store.memory(known, mission_context(self.family.name), source)
        self.manifest = {
            "identity": {
                "family": self.family.model_dump(mode="json"),
                "seed": request.seed,
                "goal": self.goal,
                "strategies": {
                    entrant.label: [identified(member, request.directories) for member in entrant.members]
                    for entrant in self.entrants
                },
                "files": fingerprints(self.directories),
                **({"learns": True} if self.learns_in_turn else {}),
            },
            "directories": [str(path) for path in self.directories],
            "versions": versions(),
            **({LEARNED_BEFORE: as_plain(self.memory.knowledge.learned)} if self.memory is not None else {}),
        }

    def tasks(self, done: Collection[RunKey]) -> list[TrialTask]:
        """Return the tasks for all missing runs; each has scenarios of one member."""
        tasks = []
        for condition, member in self._members():
            missing = [name for name in self.scenarios if (name, condition) not in done]
            for first in range(0, len(missing), TASK_SCENARIOS):
                tasks.append(self._task(tuple(missing[first : first + TASK_SCENARIOS]), condition, member))
        return tasks

    def mistake(self, record: RunRecord) -> str:
        """Return why a run is not one of this family's; it may be of further scenarios and of other strategies."""
        try:
            place_of(record.scenario)
        except DocumentError:
            return "this family has no such scenario"
        return record.mistake(self.family.name, self._request.seed, self.family.largest)

    def choosers(self) -> dict[str, Choosers]:
        """Return the strategy of each member, which chooses for the one goal."""
        directories, alone = self._request.directories, np.zeros(1, dtype=np.int64)
        problem = Problem.of(knowledge_of(self.mission, directories), self.goal)
        return {
            condition: {
                self.goal: spec_of(member).build(
                    problem, row_keys(np.random.SeedSequence([self._request.seed, k]), 1), alone, directories
                )
            }
            for k, (condition, member) in enumerate(self._members())
        }

    def task_with(self, scenario: str, condition: str, options: Mapping[str, str]) -> TrialTask:
        """Return the task of one run in which an option serves the goal."""
        return self._task((scenario,), condition, "").serving(options)

    def _members(self) -> list[tuple[str, str]]:
        """Return the condition and the name of each member of all entrants."""
        return [each for entrant in self.entrants for each in zip(entrant.conditions, entrant.members, strict=True)]

    def _task(self, names: tuple[str, ...], condition: str, member: str) -> TrialTask:
        family, request = self.family.model_copy(update={"mission": self.mission}), self._request
        places = tuple(place_of(name) for name in names)
        return TrialTask(family, request.seed, places, condition, member, self.goal, request.directories)

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the means of each strategy, and how the strategies compare with fixed options."""
        runs = FamilyRuns(
            family=self.family,
            goal=self.goal,
            seed=self._request.seed,
            scenarios=len(self.scenarios) // self._request.worlds,
            worlds=self._request.worlds,
            conditions={entrant.label: entrant.conditions for entrant in self.entrants},
            fixed=tuple(entrant.label for entrant in self.entrants if entrant.fixed),
            records=records,
        )
        report = family_report_of(runs)
        heading = f"# {self.family.name}\n\n{self.family.description}\n\n"
        return Publication(heading, family_tables(report), family_summary_json(report), draw_front(report))


def _family(request: FamilyRequest) -> FamilyConfig:
    return load_family(request.family, request.directories).with_knowledge(request.knowledge)
