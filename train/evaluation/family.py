"""The evaluation of strategies on a family of scenarios; all strategies get the same scenarios."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.errors import DocumentError, within
from selector.strategies.problem import Problem
from selforg.arrays import Ints
from train.analysis.family_report import FamilyRuns, family_report_of, family_summary_json
from train.evaluation.entrants import Entrant, entrants_of, identified, member_pilot
from train.evaluation.pipeline import Evaluation
from train.reports.family_tables import family_tables
from train.reports.write_report import Publication
from train.running.decided_goal import DecidedGoal
from train.running.needs import ALONE, Machine, Workload, check_needs
from train.running.pilots import Pilot
from train.running.provenance import fingerprints, versions
from train.running.runs import WARM_UP_LIMIT, RunKey, RunRecord
from train.running.trials import TrialSettings, run_trials

TEST_SCENARIO = r"test-[1-9][0-9]{0,5}"
"""Form of the name of a scenario of the split "test"."""
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
    machine: Machine = ALONE
    """What the evaluation may use."""

    @property
    def words(self) -> list[str]:
        """The command for this request."""
        words = ["clean-swarm", "evaluate", "--family", self.family, "--seed", str(self.seed)]
        words += [word for text in self.strategies for word in ("--strategy", text)]
        words += ["--scenarios", str(self.scenarios)] if self.scenarios is not None else []
        words += ["--knowledge", self.knowledge] if self.knowledge is not None else []
        words += ["--goal", self.goal] if self.goal is not None else []
        words += ["--force"] if self.machine.forced else []
        return words + [word for path in self.directories for word in ("--configs", str(path))]


@dataclass(frozen=True)
class TrialTask:
    """Some scenarios of a family under one member of an entrant; plain data, which can be sent to a worker process."""

    family: FamilyConfig
    seed: int
    numbers: tuple[int, ...]
    """Numbers of the scenarios, from 0 on."""
    condition: str
    member: str
    goal: str
    directories: tuple[Path, ...]
    time_limit: float = math.inf
    """Limit of simulated time in addition to that of the mission [s]."""
    record: RecordSettings | None = None
    """Where the missions are recorded; none is unless given."""

    @property
    def runs(self) -> int:
        """Number of scenarios."""
        return len(self.numbers)

    @property
    def experiment(self) -> str:
        """Name of the family."""
        return self.family.name

    @property
    def scenario(self) -> str:
        """Name of the first scenario."""
        return self.scenario_of(self.numbers[0]).id

    @property
    def mission(self) -> MissionConfig:
        """Mission of the first scenario."""
        return self.scenario_of(self.numbers[0]).mission

    @property
    def mission_seed(self) -> int:
        """Seed of the first mission."""
        return self.scenario_of(self.numbers[0]).seed

    def run(self) -> list[RunRecord]:
        """Run the scenarios in one batch."""
        began = time.perf_counter()
        scenarios = [self.scenario_of(number) for number in self.numbers]
        record = self.record and replace(self.record, about=self.naming)
        settings = TrialSettings(self.goal, TASK_SCENARIOS, directories=self.directories, record=record)
        results = run_trials(scenarios, self.pilot, settings)
        wall = round((time.perf_counter() - began) / len(scenarios), 3)
        return [
            RunRecord(self.family.name, scenario.id, self.seed, self.condition, result, wall)
            for scenario, result in zip(scenarios, results, strict=True)
        ]

    def beginning(self) -> TrialTask:
        """Return the first scenario up to `WARM_UP_LIMIT`."""
        return replace(self, numbers=self.numbers[:1], time_limit=WARM_UP_LIMIT, record=None)

    def recorded(self, settings: RecordSettings) -> TrialTask:
        """Return the runs with recordings."""
        return replace(self, record=settings)

    @property
    def naming(self) -> dict[str, str]:
        """What the heads of recordings say of the runs."""
        return {"experiment": self.family.name, "condition": self.condition}

    def scenario_of(self, number: int) -> Scenario:
        """Return the scenario of a number."""
        scenario = self.family.scenario(self.seed, number, "test")
        limit = min(scenario.mission.time_limit, self.time_limit)
        return replace(scenario, mission=scenario.mission.model_copy(update={"time_limit": limit}))

    def pilot(self, problem: Problem, teams: Ints) -> Pilot:
        """Return the pilot of the member."""
        return member_pilot(self.member, problem, teams, self.directories)


class FamilyEvaluation(Evaluation):
    """Strategies on the scenarios of a family; other strategies and scenarios can be added later."""

    growing = "strategies"

    def __init__(self, request: FamilyRequest) -> None:
        self._request, self.words = request, request.words
        self.family = _family(request)
        self.scenarios = request.scenarios or self.family.scenarios
        with within(request.family):
            missions = self.scenarios * len(request.strategies)
            check_needs(Workload(self.family.largest, missions, min(TASK_SCENARIOS, missions)), request.machine)
        batch = Batch(self.family.scenario(0, 0, "test").mission, directories=request.directories)
        problem = DecidedGoal(batch, request.goal).problem
        self.goal, self.entrants = problem.goal, entrants_of(request.strategies, problem.options)
        _check_fits(self.entrants, problem, np.zeros(batch.rows, dtype=np.int64), request.directories)
        self.total = self.scenarios * sum(len(entrant.members) for entrant in self.entrants)
        self.stem = f"{self.family.name}-seed{request.seed}"
        self.manifest = {
            "identity": {
                "family": self.family.model_dump(mode="json"),
                "seed": request.seed,
                "goal": self.goal,
                "strategies": {
                    entrant.label: [identified(member, request.directories) for member in entrant.members]
                    for entrant in self.entrants
                },
                "files": fingerprints(request.directories),
            },
            "directories": [str(path.resolve()) for path in request.directories],
            "versions": versions(),
        }

    def tasks(self, done: Collection[RunKey]) -> list[TrialTask]:
        """Return the tasks for all missing runs; each has scenarios of one member."""
        tasks, request = [], self._request
        for entrant in self.entrants:
            for condition, member in zip(entrant.conditions, entrant.members, strict=True):
                missing = [n for n in range(self.scenarios) if (f"test-{n + 1}", condition) not in done]
                for first in range(0, len(missing), TASK_SCENARIOS):
                    numbers = tuple(missing[first : first + TASK_SCENARIOS])
                    work = (self.family, request.seed, numbers, condition, member, self.goal, request.directories)
                    tasks.append(TrialTask(*work))
        return tasks

    def mistake(self, record: RunRecord) -> str:
        """Return why a run is not one of this family's; it may be of further scenarios and of other strategies."""
        if not re.fullmatch(TEST_SCENARIO, record.scenario):
            return "this family has no such scenario"
        return record.mistake(self.family.name, self._request.seed, self.family.largest)

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the means of each strategy, and how the strategies compare with fixed options."""
        runs = FamilyRuns(
            family=self.family,
            goal=self.goal,
            seed=self._request.seed,
            scenarios=tuple(f"test-{n + 1}" for n in range(self.scenarios)),
            conditions={entrant.label: entrant.conditions for entrant in self.entrants},
            fixed=tuple(entrant.label for entrant in self.entrants if entrant.fixed),
            records=records,
        )
        report = family_report_of(runs)
        heading = f"# {self.family.name}\n\n{self.family.description}\n\n"
        return Publication(heading, family_tables(report), family_summary_json(report))


def _family(request: FamilyRequest) -> FamilyConfig:
    family = load_family(request.family, request.directories)
    if request.knowledge is None:
        return family
    return family.model_copy(update={"mission": family.mission.model_copy(update={"knowledge": request.knowledge})})


def _check_fits(entrants: Sequence[Entrant], problem: Problem, teams: Ints, directories: tuple[Path, ...]) -> None:
    """Raise an error of one line for a strategy that does not exist or does not fit the family."""
    for entrant in entrants:
        for member in entrant.members:
            try:
                member_pilot(member, problem, teams, directories)
            except DocumentError as error:
                raise DocumentError(f"--strategy {entrant.label}: {error}") from error
