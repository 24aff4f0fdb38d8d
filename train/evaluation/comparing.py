"""The evaluation of a comparison: the conditions of an experiment, or strategies, each on all scenarios.

Strategies run on the scenarios of a family, in each of its variants.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import FamilyConfig, scenario_name
from clean_swarm_env.config.known import knowledge_of, mission_context
from clean_swarm_env.config.load import load_experiment, load_family
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.config.task_names import COMPARED, KIND_WORDS, named_file
from clean_swarm_env.config.types import AVOIDANCE, ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.named import FIXED, decider_named, without_digest
from clean_swarm_env.deciders.strategies import StrategyDecider
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.world.task import task_class
from selector.documents.errors import shown, within
from selector.documents.find import files_of
from selector.documents.plain import must_know
from selector.documents.trust import BASELINE
from selector.strategies.problem import Problem
from selector.strategies.registry import BY_SCORE
from selector.strategies.streams import row_keys
from selforg.network.planning.planner import check_planner
from train.analysis.runs import Measured, Runs
from train.evaluation.comparison import Comparison, Deciders
from train.evaluation.conditions import UNTAUGHT, check_fit, check_goals, conditions_of, remarks_on, with_baselines
from train.evaluation.evaluation import Done, Evaluation
from train.evaluation.publications import of_disturbances, of_experiment, of_family
from train.reports.text_table import Publication
from train.request import Request
from train.running.needs import check_needs
from train.running.run_folder import fingerprints
from train.running.runs import RunRecord
from train.running.trial_task import TASK_SCENARIOS, TrialTask

OF_FAMILIES = dict.fromkeys(("--starts", "--condition"), "with an experiment, and no strategies,")
OF_DISTURBANCES = dict.fromkeys((*OF_FAMILIES, "--store", "--learn"), "with experiments without disturbances")
OF_CONDITIONS = {
    "--goal": "with strategies, or an experiment with disturbances",
    "--learn": "with strategies, which choose once in a mission,",
}
"""Options that mean nothing where strategies are compared, under disturbances, or conditions: where they do."""


class Starts(NamedTuple):
    """Where the start configurations of an experiment come from."""

    sentence: str = "the experiment's own start configurations"
    """In words, for the report."""
    stem: str = ""
    """End of the name of the default directory; empty for the experiment's own."""
    measured: Measured = MappingProxyType({})
    """Figures measured on them elsewhere."""


class Comparing(Evaluation):
    """Conditions on scenarios; other conditions, and further scenarios of a family, can be added later.

    Args:
        request: the request.
        document: the experiment or the family, unless it is the one that the request names.

    Attributes:
        document: the experiment or the family.
        problem: goal and options that strategies choose among.
        batch: the world of the first scenario.
        decided: lines on the goals that some of the strategies decide.
        noticed: lines on conditions whose scores do not do what they seem to.

    """

    def __init__(self, request: Request, document: ExperimentConfig | FamilyConfig | None = None) -> None:
        super().__init__(request)
        self.document, self.starts = (document, Starts()) if document is not None else asked_of(request)
        _check_meant(request, self.document)
        document, where = self.document, request.name if request.starts is None else shown(request.starts)
        strategies = request.strategies
        if isinstance(document, FamilyConfig):
            strategies, count = strategies or document.strategies or (FIXED,), request.scenarios or document.scenarios
            self.scenarios = [scenario_name("test", k, world) for k in range(count) for world in range(request.worlds)]
            missions = len(self.scenarios) * max(len(strategies), 1)
        else:
            self.scenarios = [start.id for start in document.starts]
            missions = len(self.scenarios) * len(document.conditions)
        with within(where):
            check_needs(document.largest, missions, request.machine, min(TASK_SCENARIOS, missions))
            first = document.scenario_named(0, self.scenarios[0]).mission.beginning_with({})
            if request.goal is None:
                check_goals(strategies, first, request.directories)
            _check_planner(first)
            self.batch = Batch(first, directories=request.directories)
        if isinstance(document, FamilyConfig):
            goal, told = request.goal, "--strategy {}"
            self.problem = DecidedGoal(self.batch, goal).problem
            conditions = conditions_of(strategies, self.problem.options)
            if not request.store.learn:
                conditions = with_baselines(conditions, self.problem.options, document.mission)
        else:
            goals = [coordinator.model.goal for coordinator in self.batch.worlds.coordinators]
            goal, told = AVOIDANCE if AVOIDANCE in goals else goals[0], f"{where}: condition {{!r}}"
            self.problem, given = DecidedGoal(self.batch, goal).problem, document.conditions
            conditions = {one.name: Deciders(members=(one.strategy,), scores=one.scores) for one in given}
        self.decided, self.noticed = list[str](), list[str]()
        fewest = document.robots[0] if isinstance(document, FamilyConfig) else first.robots.count
        for label, one in conditions.items():
            with within(told.format(label)):
                for member in one.members:
                    decider_named(member, request.directories).check_team(fewest)
                changed = first.model_copy(update={"scores": {**first.scores, **one.scores}})
                own = Batch(changed, directories=request.directories) if one.scores else self.batch
                asked = request.goal is not None
                self.decided += check_fit(label, one, own, goal, request.directories, asked=asked)
            self.noticed += [f"{told.format(label)}: {line}" for line in _passed_over(one, own)]
        self.mission = document.mission.beginning_with({})
        if not task_class(first).measures and (isinstance(document, ExperimentConfig) or document.disturbances):
            self.led_by = "duration"
        self.stem = f"{document.name}-seed{request.seed}{self.starts.stem}"
        self.context = mission_context(first.name)
        known = knowledge_of(self.mission, request.directories)
        source = f"family {document.name}, {self.problem.goal}, seed {request.seed}"
        store = replace(request.store, path=request.store.path or document.mission.store or None)
        self.comparison = Comparison(
            document=document,
            seed=request.seed,
            goal=self.problem.goal,
            asked=request.goal is not None,
            conditions={label: self._identified(one) for label, one in conditions.items()},
            files=fingerprints(self.directories),
            directories=self.directories,
        )
        if store.learn:
            self.choosers()  # a strategy that cannot choose for a whole mission is an error
        self.memory = store.memory(known, self.context, source)
        self.identify(self.comparison)

    def _identified(self, condition: Deciders) -> Deciders:
        members = tuple(decider_named(member, self.directories).identity for member in condition.members)
        return condition.model_copy(update={"members": members})

    @property
    def labels(self) -> dict[str, tuple[str, ...]]:
        """Label of a condition -> names under which its runs are kept."""
        return {label: condition.names(label) for label, condition in self.comparison.conditions.items()}

    def remarks(self) -> list[str]:
        """Return what strategies never take, and which have learned nothing and do not here."""
        missions = [variant.largest for variant in self.document.variants.values()]
        conditions, request = self.comparison.conditions, self.request
        told = [*self.noticed, *remarks_on(conditions, self.batch, request.goal, request.directories, missions)]
        if request.directories:
            ours = {files_of(kind).get(request.name) for kind in KIND_WORDS} - {None}
            if ours and (own := named_file(request.name, request.directories, kinds=COMPARED)) not in ours:
                told.append(f"{request.name}: {own}, which hides ours of the same name")
        return [remark for remark in told if not (self.request.store.path and remark.endswith(UNTAUGHT))]

    def tasks(self, done: Done) -> list[TrialTask]:
        """Return the tasks for all missing runs; each has scenarios of one member in one variant."""
        return [task.knowing(self.learned) for task in self.comparison.tasks(self.scenarios, done)]

    def choosers(self) -> dict[str, StrategyDecider]:
        """Return the decider of each member: with one row, it chooses one option for the whole team and mission."""
        found, directories, alone = dict[str, StrategyDecider](), self.request.directories, np.zeros(1, dtype=np.int64)
        problem = Problem.of(knowledge_of(self.mission, directories), self.problem.goal)
        for k, (name, kept) in enumerate(self.comparison.bases.items()):
            named = decider_named(without_digest(kept.member), directories)
            decider = named.build(problem, alone) if named.strategy else None
            if not isinstance(decider, StrategyDecider):
                raise ConfigurationError(f"--learn: {named.text}: expected a strategy that chooses once in a mission")
            decider.strategy.reseed(alone, row_keys(np.random.SeedSequence([self.request.seed, k]), 1))
            found[name] = decider
        return found

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return how the conditions compare: with each other, or under disturbances."""
        runs, starts = self.runs(records), self.starts
        if isinstance(self.document, ExperimentConfig):
            return of_experiment(runs, starts.measured, starts.sentence, own_starts=not starts.stem)
        return of_disturbances(runs) if self.document.disturbances else of_family(runs, self.decided)

    def runs(self, records: Sequence[RunRecord], labels: Mapping[str, tuple[str, ...]] | None = None) -> Runs:
        """Return the finished runs of all conditions, or of some: label -> names under which they are kept."""
        names, worlds, conditions = self.scenarios, self.request.worlds, self.comparison.conditions
        return Runs(
            document=self.document,
            goal=self.problem.goal,
            seed=self.request.seed,
            names=tuple(tuple(names[k : k + worlds]) for k in range(0, len(names), worlds)),
            conditions=self.labels if labels is None else labels,
            records=records,
            baseline=next((label for label, one in conditions.items() if one.members == (BASELINE,)), BASELINE),
        )


def _passed_over(condition: Deciders, batch: Batch) -> list[str]:
    """Return for which goals a condition gives scores of which the highest option is none that experts would hold."""
    told = []
    for number, (goal, names) in enumerate(batch.options.items()):
        given, held = condition.scores.get(goal, {}), names[batch.choices.default[number]]
        if given and held not in given and condition.members == (BY_SCORE,):
            best = max(given, key=lambda name: given[name])
            told.append(f"{best} has {given[best]:g} for {goal}, and robots hold {held}, which has more")
    return told


def _check_planner(mission: MissionConfig) -> None:
    try:
        check_planner(mission.network.planner)
    except (ValueError, ModuleNotFoundError) as error:
        raise ConfigurationError(f"mission.network.planner: {error}") from error


def _check_meant(request: Request, document: ExperimentConfig | FamilyConfig) -> None:
    """Raise ConfigurationError for an option that means nothing for a document."""
    given: dict[str, object] = {"--starts": request.starts, "--condition": request.conditions, "--goal": request.goal}
    given |= {"--store": request.store.path, "--learn": request.store.learn}
    of_families = OF_DISTURBANCES if isinstance(document, FamilyConfig) and document.disturbances else OF_FAMILIES
    for option, where in (OF_CONDITIONS if isinstance(document, ExperimentConfig) else of_families).items():
        if given[option]:
            raise ConfigurationError(f"{option}: expected {where} only")


def asked_of(request: Request) -> tuple[ExperimentConfig | FamilyConfig, Starts]:
    """Return what a request compares on: the experiment of its name unless it compares strategies, else the family."""
    directories = request.directories
    if request.strategies or request.knowledge or request.worlds > 1 or Path(request.name).is_dir():
        return load_family(request.name, directories).with_knowledge(request.knowledge, directories), Starts()
    found = load_experiment(request.name, directories)
    if isinstance(found, FamilyConfig):
        return found, Starts()
    known = [condition.name for condition in found.conditions]
    for name in request.conditions:
        must_know("condition", name, known, found.name)
    chosen = tuple(one for one in found.conditions if not request.conditions or one.name in request.conditions)
    return _with_starts(found.model_copy(update={"conditions": chosen}), request)


def _with_starts(experiment: ExperimentConfig, request: Request) -> tuple[ExperimentConfig, Starts]:
    """Return an experiment with the starts that are asked for, and where they come from."""
    if request.starts is not None:
        if request.scenarios is not None:
            raise ConfigurationError("--scenarios and --starts: expected one of them, got both")
        file = task_class(experiment.mission).Starts.read(request.starts)
        with within(shown(request.starts)):
            mission = file.world_of(experiment.mission)
        told = Starts(str(request.starts), f"-{request.starts.stem}", file.measured)
        return experiment.model_copy(update={"mission": mission, "starts": file.starts}), told
    if request.scenarios is None and experiment.starts:
        return experiment, Starts()
    count = request.scenarios or experiment.scenarios
    with within(request.name):
        check_needs(experiment.mission, count * len(experiment.conditions), request.machine)
        drawn = tuple(random_start(experiment.mission, request.seed, index) for index in range(count))
    told = Starts(f"{count} random start configurations of seed {request.seed}", f"-{count}-scenarios")
    return experiment.model_copy(update={"starts": drawn}), told
