"""The evaluation of strategies on a family of scenarios; all strategies get the same scenarios."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, place_of, scenario_name
from clean_swarm_env.config.known import knowledge_of, mission_context
from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import Batch
from selector.documents.errors import DocumentError, within
from selector.strategies.problem import Problem
from selector.strategies.streams import row_keys
from train.analysis.family_report import FamilyRuns, family_report_of, family_summary_json
from train.deciders.decided_goal import DecidedGoal
from train.deciders.named import FIXED, decider_named
from train.evaluation.base import Asked, Choosers, Evaluation
from train.evaluation.entrants import check_fit, entrants_of, with_baselines
from train.evaluation.trial_task import TASK_SCENARIOS, TrialTask
from train.knowledge_store import NO_STORE, StoreRequest, as_plain
from train.reports.family_figure import draw_front
from train.reports.family_tables import family_tables
from train.reports.write_report import Publication
from train.running.command import command_words
from train.running.needs import ALONE, Machine, Workload, check_needs
from train.running.provenance import fingerprints, versions
from train.running.run_folder import LEARNED_BEFORE
from train.running.runs import RunKey, RunRecord


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
        of_strategies = {"strategy": self.strategies, "goal": self.goal, "learn": self.store.learn}
        return command_words(
            *(("score",) if self.scoring else ("evaluate", "--family")),
            self.family,
            seed=self.seed,
            store=self.store.shown,
            **({} if self.scoring else of_strategies),
            scenarios=self.scenarios,
            world_seeds=self.worlds if self.worlds > 1 else None,
            knowledge=self.knowledge,
            force=self.machine.forced,
            configs=self.directories,
        )


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
        batch = Batch(first, directories=request.directories)
        problem = DecidedGoal(batch, request.goal).problem
        self.goal, self.options = problem.goal, problem.options
        self.entrants = entrants_of(request.strategies, problem.options)
        if not (request.scoring or request.store.learn):
            self.entrants = with_baselines(self.entrants, problem.options, self.mission)
        check_fit(self.entrants, batch, problem, request.directories)
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
        self.asked = Asked(scenarios=len(indices), worlds=request.worlds, scoring=request.scoring)
        self.context = mission_context(self.family.name)
        self.memory = store.memory(known, self.context, source)
        self.manifest = {
            "identity": {
                "family": self.family.model_dump(mode="json"),
                "seed": request.seed,
                "goal": self.goal,
                "strategies": {
                    entrant.label: [decider_named(member, request.directories).identity for member in entrant.members]
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
                self.goal: decider_named(member, directories)
                .spec()
                .build(problem, row_keys(np.random.SeedSequence([self._request.seed, k]), 1), alone)
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
