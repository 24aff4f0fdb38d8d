"""The evaluation of an experiment: every condition on every start configuration."""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.known import knowledge_of, mission_context
from clean_swarm_env.config.load import load_experiment
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.config.types import AVOIDANCE, ConfigurationError
from clean_swarm_env.world.task import coordinators_of, task_class
from selector.configurations.library import library_of
from selector.coordination.selection import BY_SCORE
from selector.documents.errors import shown, within
from selector.knowledge import load_knowledge
from selforg.network.planning.planner import check_planner
from selforg.registry import unknown
from train.analysis.report import report_of, summary_of, verdict_of
from train.evaluation.base import Done, Evaluation
from train.evaluation.entrants import UNTAUGHT
from train.evaluation.scenarios import experiment_tasks
from train.reports.experiment_tables import all_tables
from train.reports.text_table import Publication
from train.request import Request
from train.running.needs import check_needs, needs_of
from train.running.runs import RunRecord
from train.running.trial_task import TASK_SCENARIOS, TrialTask

OWN_STARTS = "own starts"


class Starts(NamedTuple):
    """Where the start configurations of an experiment come from."""

    sentence: str
    """In words, for the report."""
    source: str = OWN_STARTS
    """In two words or by a path."""
    stem: str = ""
    """End of the name of the default directory."""
    measured: Mapping[str, Mapping[str, Mapping[str, float | None]]] = {}
    """Figures measured on them elsewhere: scenario -> name of a condition -> figure -> value."""


class ExperimentEvaluation(Evaluation):
    """The conditions of an experiment on its start configurations, on random ones, or on those of a file."""

    def __init__(self, request: Request) -> None:
        super().__init__(request)
        directories = self.directories
        chosen = with_conditions(load_experiment(request.name, directories), request.conditions)
        self.experiment, self.starts = with_starts(chosen, request)
        self.seed, self.stem = request.seed, f"{chosen.name}-seed{request.seed}{self.starts.stem}"
        self.goal = check_mission(self.experiment, directories, request.name)
        if request.store.learn:
            raise ConfigurationError("--learn: expected strategies, which choose once in a mission, and no experiment")
        store = replace(request.store, path=request.store.path or self.experiment.mission.store or None)
        self.mission = self.experiment.mission.model_copy(update={"store": ""})
        self.scenarios = [start.id for start in self.experiment.starts]
        self.context = mission_context(chosen.mission.name)
        self.memory = store.memory(knowledge_of(self.mission, directories), self.context, "")
        with within(shown(request.starts) if request.starts is not None else request.name):
            tasks = self.tasks({})
            for task in {task.condition: task for task in tasks}.values():
                with within(f"condition {task.condition!r}"):
                    task.team()
            self._missions = {
                key: one.mission for task in tasks for key, one in zip(task.keys, task.scenarios, strict=True)
            }
            largest = max(self._missions.values(), key=lambda mission: needs_of(mission).memory)
            check_needs(largest, len(self._missions), request.machine, min(TASK_SCENARIOS, len(self._missions)))
        named = {task.condition: task.named for task in tasks if task.member != BY_SCORE.name}
        deciders = {condition: one.identity for condition, one in named.items()}
        self._untaught = [condition for condition, one in named.items() if one.learns]
        identity = {
            "experiment": self.experiment.name,
            "seed": self.seed,
            "configuration": self.experiment.model_dump(mode="json"),
            "directories": [str(directory) for directory in directories],
            "goal": self.goal,
            **({"deciders": deciders} if deciders else {}),
        }
        self.identify(identity, platform=platform.platform())

    def remarks(self) -> list[str]:
        """Return that a strategy which could learn has learned nothing."""
        return [] if self.request.store.path else [f"{name}: {UNTAUGHT}" for name in self._untaught]

    def tasks(self, done: Done) -> list[TrialTask]:
        """Return the tasks for all missing runs."""
        beginning = self.experiment.model_copy(update={"mission": self.mission})
        return experiment_tasks(beginning, self.seed, self.directories, self.goal, done)

    def mistake(self, record: RunRecord) -> str:
        """Return why a run is not one of this experiment's."""
        if record.key not in self._missions:
            return "this evaluation has no such run"
        return record.mistake(self.experiment.name, self.seed, self._missions[record.key])

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return Table 1, ratios between conditions, comparisons with measured figures, and the picture."""
        from train.reports.figures import draw_experiment  # waits: the runs need no Matplotlib

        report = report_of(
            self.experiment, self.seed, records, self.starts.measured, own_starts=self.starts.source == OWN_STARTS
        )
        about = f"{self.experiment.description}\nSeed {self.seed}; {self.starts.sentence}."
        tables, summary = all_tables(report), summary_of(report)
        return Publication(self.experiment.name, about, verdict_of(report), tables, summary, draw_experiment(report))


def with_conditions(experiment: ExperimentConfig, chosen: Sequence[str]) -> ExperimentConfig:
    """Return an experiment with only the `chosen` conditions; with all if none is chosen."""
    known = [condition.name for condition in experiment.conditions]
    for name in chosen:
        if name not in known:
            raise ConfigurationError(f"{experiment.name}: {unknown('condition', name, known)}")
    conditions = tuple(c for c in experiment.conditions if not chosen or c.name in chosen)
    return experiment.model_copy(update={"conditions": conditions})


def with_starts(experiment: ExperimentConfig, request: Request) -> tuple[ExperimentConfig, Starts]:
    """Return an experiment with the starts that are asked for, and where they come from."""
    if request.starts is not None:
        if request.scenarios is not None:
            raise ConfigurationError("--scenarios and --starts: expected one of them, got both")
        given, path = task_class(experiment.mission).Starts.read(request.starts), str(request.starts)
        with within(shown(request.starts)):
            mission = given.world_of(experiment.mission)
        changes = {"mission": mission, "starts": given.starts}
        return experiment.model_copy(update=changes), Starts(path, path, f"-{request.starts.stem}", given.measured)
    if request.scenarios is None and experiment.starts:
        return experiment, Starts("the experiment's own start configurations")
    count = request.scenarios or experiment.scenarios
    with within(request.name):
        check_needs(experiment.mission, count * len(experiment.conditions), request.machine)
        drawn = tuple(random_start(experiment.mission, request.seed, index) for index in range(count))
    told = f"{count} random start configurations of seed {request.seed}"
    changes = {"starts": drawn}
    return experiment.model_copy(update=changes), Starts(told, "random starts", f"-{count}-scenarios")


def check_mission(experiment: ExperimentConfig, directories: tuple[Path, ...], where: str) -> str:
    """Return the goal that is decided unless a decider was made for others.

    Raise an error of one line if something that the mission names does not exist or cannot be built: the planner, the
    robot's document, the expert knowledge, its configurations or the scores. Strategies are checked when they are read.
    """
    network = experiment.mission.network
    try:
        check_planner(network.planner)
    except (ValueError, ModuleNotFoundError) as error:
        raise ConfigurationError(f"{where}: mission.network.planner: {error}") from error
    library = library_of(directories)
    with within(f"{where}: mission.knowledge"):
        knowledge = load_knowledge(experiment.mission.knowledge, directories)
        library.check(knowledge)
    with within(where):
        models = coordinators_of(experiment.mission, knowledge, library, directories)
        task_class(experiment.mission).robot(experiment.mission, models, directories)
    for condition in experiment.conditions:
        with within(f"{where}: condition {condition.name!r}: scores"):
            knowledge.with_scores(condition.scores)
    goals = [model.goal for model in models]
    return AVOIDANCE if AVOIDANCE in goals else goals[0]
