"""The evaluation of an experiment: every condition on every start configuration."""

import platform
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.load import load_experiment
from clean_swarm_env.config.needs import needs_of
from clean_swarm_env.config.starts import load_starts, random_start
from clean_swarm_env.world.cleaning_robot import coordinators_of, robot_network
from selector.configurations.library import library_of
from selector.documents.errors import shown, within
from selector.knowledge import load_knowledge
from selforg.network.planning.names import check_planner
from selforg.registry import unknown
from train.analysis.reference import Measured
from train.analysis.report import report_of, summary_json
from train.evaluation.pipeline import Evaluation
from train.reports.experiment_tables import all_tables
from train.reports.figure import draw
from train.reports.write_report import Publication
from train.running.needs import ALONE, Machine, Workload, check_needs
from train.running.provenance import fingerprints, versions
from train.running.runs import RunKey, RunRecord, RunTask, tasks_of


@dataclass(frozen=True)
class ExperimentRequest:
    """The request of the user."""

    experiment: str
    """Name of an experiment, or path to its YAML file."""
    seed: int
    scenarios: int | None = None
    """Number of random start configurations, in place of the experiment's own."""
    starts: Path | None = None
    """File of start configurations, in place of the experiment's own."""
    conditions: tuple[str, ...] = ()
    """Names of the conditions to run; empty: all."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""
    machine: Machine = ALONE
    """What the evaluation may use."""

    @property
    def words(self) -> list[str]:
        """The command for this request."""
        words = ["clean-swarm", "evaluate", self.experiment, "--seed", str(self.seed)]
        words += ["--scenarios", str(self.scenarios)] if self.scenarios is not None else []
        words += ["--starts", str(self.starts)] if self.starts is not None else []
        words += [word for name in self.conditions for word in ("--condition", name)]
        words += ["--force"] if self.machine.forced else []
        return words + [word for path in self.directories for word in ("--configs", str(path))]


class ExperimentEvaluation(Evaluation):
    """The conditions of an experiment on its start configurations, on random ones, or on those of a file."""

    def __init__(self, request: ExperimentRequest) -> None:
        if request.scenarios is not None and request.starts is not None:
            raise ConfigurationError("--scenarios and --starts: expected one of them, got both")
        directories = tuple(directory.resolve() for directory in request.directories)
        chosen = with_conditions(load_experiment(request.experiment, directories), request.conditions)
        self.own_starts = request.starts is None and request.scenarios is None and bool(chosen.starts)
        self.measured: Measured = {}
        self.seed, self.words, self.stem = request.seed, request.words, f"{chosen.name}-seed{request.seed}"
        if request.starts is not None:
            given = load_starts(request.starts)
            self.measured, self.starts_from = given.measured, str(request.starts)
            self.stem += f"-{request.starts.stem}"
            with within(shown(request.starts)):
                mission = given.world_of(chosen.mission)
            changes: dict[str, Any] = {"mission": mission, "starts": given.starts}
        elif self.own_starts:
            self.starts_from, changes = "the experiment's own start configurations", {}
        else:
            count = request.scenarios or chosen.scenarios
            with within(request.experiment):
                check_needs(Workload(chosen.mission, count * len(chosen.conditions)), request.machine)
            self.starts_from = f"{count} random start configurations of seed {request.seed}"
            self.stem += f"-{count}-scenarios"
            with within(request.experiment):
                starts = tuple(random_start(chosen.mission, request.seed, index) for index in range(count))
            changes = {"starts": starts}
        self.experiment = chosen.model_copy(update=changes)
        check_mission(self.experiment, directories, request.experiment)
        with within(shown(request.starts) if request.starts is not None else request.experiment):
            self._tasks = tasks_of(self.experiment, self.seed, directories)
            largest = max((task.mission for task in self._tasks), key=lambda mission: needs_of(mission).memory)
            check_needs(Workload(largest, len(self._tasks)), request.machine)
        self._missions = {(task.scenario, task.condition): task.mission for task in self._tasks}
        self.total = len(self._tasks)
        self.manifest = {
            "identity": {
                "experiment": self.experiment.name,
                "seed": self.seed,
                "configuration": self.experiment.model_dump(mode="json"),
                "files": fingerprints(directories),
                "directories": [str(directory) for directory in directories],
            },
            "starts_from": self.starts_from,
            "versions": versions(),
            "platform": platform.platform(),
        }

    def tasks(self, done: Collection[RunKey]) -> list[RunTask]:
        """Return one task for each run that is missing."""
        return [task for task in self._tasks if (task.scenario, task.condition) not in done]

    def mistake(self, record: RunRecord) -> str:
        """Return why a run is not one of this experiment's."""
        if record.key not in self._missions:
            return "this evaluation has no such run"
        return record.mistake(self.experiment.name, self.seed, self._missions[record.key])

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return Table 1, ratios between conditions, comparisons with measured figures, and the picture."""
        report = report_of(self.experiment, self.seed, records, self.measured, own_starts=self.own_starts)
        about = f"{self.experiment.description}\nSeed {self.seed}; {self.starts_from}."
        heading = f"# {self.experiment.name}\n\n{about}\n\n"
        return Publication(heading, all_tables(report), summary_json(report), draw(report))


def with_conditions(experiment: ExperimentConfig, chosen: Sequence[str]) -> ExperimentConfig:
    """Return an experiment with only the `chosen` conditions; with all if none is chosen."""
    known = [condition.name for condition in experiment.conditions]
    for name in chosen:
        if name not in known:
            raise ConfigurationError(f"{experiment.name}: {unknown('condition', name, known)}")
    conditions = tuple(c for c in experiment.conditions if not chosen or c.name in chosen)
    return experiment.model_copy(update={"conditions": conditions})


def check_mission(experiment: ExperimentConfig, directories: tuple[Path, ...], where: str) -> None:
    """Raise an error of one line if something that the mission names does not exist or cannot be built.

    Checked are the planner, the robot's document, the expert knowledge, its configurations and the scores. Strategies
    are checked when they are read.
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
    with within(f"{where}: mission.network.robot"):
        robot_network(network, coordinators_of(network, knowledge, library, directories), directories)
    for condition in experiment.conditions:
        try:
            knowledge.with_scores(condition.scores)
        except ValueError as error:
            raise ConfigurationError(f"{where}: condition {condition.name!r}: scores: {error}") from error
