"""The evaluation of strategies on a family of scenarios, alone or under disturbances.

All strategies get the same scenarios, in each variant of the family.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, RobustnessConfig, Scenario, place_of, scenario_name
from clean_swarm_env.config.known import knowledge_of, mission_context
from clean_swarm_env.config.load import load_family, own_mission
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.deciders.strategies import StrategyDecider
from clean_swarm_env.learning.batch import Batch
from selector.documents.errors import DocumentError, within
from selector.strategies.problem import Problem
from selector.strategies.streams import row_keys
from train.analysis.family_report import FamilyRuns, family_report_of
from train.analysis.robustness_report import RobustnessReport, durations_over
from train.evaluation.base import Done, Evaluation
from train.evaluation.entrants import UNTAUGHT, check_fit, check_goals, entrants_of, remarks_on, with_baselines
from train.evaluation.scenarios import scenario_named, variants_of
from train.reports.family_tables import family_tables, robustness_tables
from train.reports.text_table import Publication
from train.request import Request
from train.running.needs import check_needs
from train.running.runs import RunRecord, under
from train.running.trial_task import TASK_SCENARIOS, TrialTask


class FamilyEvaluation(Evaluation):
    """Strategies on the scenarios of a family; other strategies and scenarios can be added later.

    Args:
        request: the request.
        family: the family, unless it is the one that the request names; it may have disturbances.
        terms: terms of the observation beside those of the mission.
        settings: what the identity says besides of the evaluation.

    Attributes:
        family: the family.
        goal: the goal that the strategies choose options for.
        options: its options.
        entrants: the strategies.
        decided: lines on the goals that some of them decide.
        variants: families under which they run; see `variants_of`.

    """

    growing = "strategies"
    beside_baselines = True
    """Whether Off and Random come beside the strategies that are asked for."""

    def __init__(
        self,
        request: Request,
        family: FamilyConfig | None = None,
        terms: Sequence[str] = (),
        **settings: object,
    ) -> None:
        super().__init__(request)
        self.family = family or load_family(request.name, request.directories).with_knowledge(
            request.knowledge, request.directories, terms
        )
        with within(request.name):
            missions = (request.scenarios or self.family.scenarios) * request.worlds * max(len(request.strategies), 1)
            check_needs(self.family.largest, missions, request.machine, min(TASK_SCENARIOS, missions))
            first = self.family.scenario(0, 0, "test").mission.model_copy(update={"store": ""})
            if request.goal is None:
                check_goals(request.strategies, first, request.directories)
            self.batch = Batch(first, directories=request.directories)
        self.mission = self.family.mission.model_copy(update={"store": ""})
        self.problem = DecidedGoal(self.batch, request.goal).problem
        self.goal, self.options = self.problem.goal, self.problem.options
        self.variants = variants_of(self.family)
        self.entrants = entrants_of(request.strategies, self.options)
        if self.beside_baselines and not request.store.learn:
            self.entrants = with_baselines(self.entrants, self.options, self.mission)
        self.decided = check_fit(self.entrants, self.batch, request.goal, request.directories)
        indices = range(request.scenarios or self.family.scenarios)
        self.scenarios = [scenario_name("test", k, world) for k in indices for world in range(request.worlds)]
        self.stem = f"{self.family.name}-seed{request.seed}"
        store = replace(request.store, path=request.store.path or self.family.mission.store or None)
        if store.learn:
            self.choosers()  # a strategy that cannot choose for a whole mission is an error
        source = f"family {self.family.name}, {self.goal}, seed {request.seed}"
        known = knowledge_of(self.mission, request.directories)
        self.context = mission_context(self.family.name)
        self.memory = store.memory(known, self.context, source)
        identity = {
            "family": self.family.model_dump(mode="json", exclude={"strategies"}),
            "seed": request.seed,
            "goal": self.goal,
            "strategies": {
                entrant.label: [decider_named(member, request.directories).identity for member in entrant.members]
                for entrant in self.entrants
            },
            **settings,
        }
        self.identify(identity, directories=[str(path) for path in self.directories])

    def remarks(self) -> list[str]:
        """Return what strategies never take, and which have learned nothing and do not here."""
        missions = [family.largest for family in self.variants.values()]
        told = remarks_on(self.entrants, self.batch, self.request.goal, self.request.directories, missions)
        return [remark for remark in told if not (self.request.store.path and remark.endswith(UNTAUGHT))]

    def tasks(self, done: Done) -> list[TrialTask]:
        """Return the tasks for all missing runs; each has scenarios of one member in one variant of the family."""
        tasks = []
        for variant, family in self.variants.items():
            drawn = cache(partial(self.scenario, family))
            for condition, member in self._members():
                name = under(variant, condition)
                missing = [drawn(scenario) for scenario in self.scenarios if (scenario, name) not in done]
                tasks += self.task(missing, name, member).parts()
        return tasks

    def task(self, scenarios: Sequence[Scenario], condition: str, member: str) -> TrialTask:
        """Return the task of a member on scenarios."""
        own = (self.family.name, self.request.seed, tuple(scenarios), condition, member, self.request.goal or "")
        return TrialTask(*own, directories=self.request.directories)

    def scenario(self, family: FamilyConfig, name: str) -> Scenario:
        """Return a scenario of a variant of the family, with what was learned of options."""
        drawn = scenario_named(family, self.request.seed, name)
        changes = {"store": "", "learned": self.mission.learned}
        return replace(drawn, mission=drawn.mission.model_copy(update=changes))

    def mistake(self, record: RunRecord) -> str:
        """Return why a run is not one of this family's; it may be of further scenarios and of other strategies."""
        try:
            place_of(record.scenario)
        except DocumentError:
            return "this family has no such scenario"
        return record.mistake(self.family.name, self.request.seed, self.family.largest)

    def choosers(self) -> dict[str, StrategyDecider]:
        """Return the decider of each member: with one row, it chooses one option for the whole team and mission."""
        found, directories, alone = dict[str, StrategyDecider](), self.request.directories, np.zeros(1, dtype=np.int64)
        problem = Problem.of(knowledge_of(self.mission, directories), self.goal)
        for k, (condition, member) in enumerate(self._members()):
            named = decider_named(member, directories)
            decider = named.build(problem, alone) if named.strategy else None
            if not isinstance(decider, StrategyDecider):
                raise ConfigurationError(f"--learn: {member}: expected a strategy that chooses once in a mission")
            decider.strategy.reseed(alone, row_keys(np.random.SeedSequence([self.request.seed, k]), 1))
            found[condition] = decider
        return found

    def _members(self) -> list[tuple[str, str]]:
        """Return the condition and the name of each member of all entrants."""
        return [each for entrant in self.entrants for each in zip(entrant.conditions, entrant.members, strict=True)]

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return how the strategies compare: with each other, or under disturbances."""
        runs = self.runs(records, {entrant.label: entrant.conditions for entrant in self.entrants})
        from train.reports.figures import draw_family, draw_robustness  # waits: the runs need no Matplotlib

        named = (self.family.name, self.family.description)
        if isinstance(self.family, RobustnessConfig):
            found = RobustnessReport.of(self.family, runs)
            ranking = durations_over(self.family, runs)
            tables = robustness_tables(found, ranking)
            return Publication(*named, found.verdict(ranking), tables, found.content, draw_robustness(found))
        report = family_report_of(runs)
        first, *others = family_tables(report)
        own, here = setting_of(own_mission(self.mission.task.name)), setting_of(self.mission)
        stated = [f"targets are stated for {own}, not for {here}"] if report.measured and own != here else []
        first = replace(first, notes=(*first.notes, *self.decided, *stated))
        return Publication(*named, report.verdict, [first, *others], report.content, draw_family(report))

    def runs(self, records: Sequence[RunRecord], conditions: Mapping[str, tuple[str, ...]]) -> FamilyRuns:
        """Return the finished runs; `conditions`: see there."""
        return FamilyRuns(
            family=self.family,
            goal=self.goal,
            seed=self.request.seed,
            scenarios=len(self.scenarios) // self.request.worlds,
            worlds=self.request.worlds,
            conditions=conditions,
            fixed=tuple(entrant.label for entrant in self.entrants if entrant.fixed),
            records=records,
        )


def setting_of(mission: MissionConfig) -> str:
    """Return what users choose of a mission, in words."""
    return f"{mission.robots.count} robots, {mission.time_limit:g} s, {mission.world.ground}"
