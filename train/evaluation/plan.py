"""What an evaluation is going to run: the experiment with its start configurations, and how to recognise it again."""

import hashlib
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import configs
from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.files import load_experiment
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.starts import load_starts, random_start
from clean_swarm_env.world.robot import coordinators_of, robot_model
from selector.configurations.library import library_of
from selector.knowledge import load_knowledge
from selforg.network.planning.names import check_planner as check_planner_name
from selforg.registry import unknown
from train.analysis.reference import Measured

PACKAGES = ("clean-swarm", "numpy", "numba", "pymunk", "scipy", "pydantic")
"""Packages whose versions the manifest states."""
FINGERPRINTED = ("knowledge", "mechanisms", "robots")
"""Kinds of shipped files that decide what a run is, beside its configuration."""


@dataclass(frozen=True)
class Request:
    """What the user asked for."""

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


@dataclass(frozen=True)
class Plan:
    """What is going to run."""

    experiment: ExperimentConfig
    """The experiment with the start configurations that it runs on."""
    seed: int
    measured: Measured
    own_starts: bool
    """Whether the start configurations are the experiment's own."""
    starts_from: str
    """Where the start configurations come from."""
    stem: str
    """Name of the default directory for the results."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, as absolute paths."""

    @property
    def manifest(self) -> dict[str, Any]:
        """Content of `manifest.json`: by `identity` the runs are recognised, the rest is for the reader."""
        return {
            "identity": {
                "experiment": self.experiment.name,
                "seed": self.seed,
                "configuration": self.experiment.model_dump(mode="json"),
                "files": fingerprints(FINGERPRINTED, self.directories),
                "directories": [str(directory) for directory in self.directories],
            },
            "starts_from": self.starts_from,
            "versions": versions(),
            "platform": platform.platform(),
        }


def plan_of(request: Request) -> Plan:
    """Resolve what the user asked for; whatever does not exist or fit raises an error of one line."""
    if request.scenarios is not None and request.starts is not None:
        raise ConfigurationError("--scenarios and --starts: expected one of them, got both")
    directories = tuple(directory.resolve() for directory in request.directories)
    experiment = _with_conditions(load_experiment(request.experiment, directories), request.conditions)
    stem = f"{experiment.name}-seed{request.seed}"
    if request.starts is not None:
        given = load_starts(request.starts)
        experiment = experiment.model_copy(
            update={"mission": given.world_of(experiment.mission), "starts": given.starts}
        )
        stem = f"{stem}-{request.starts.stem}"
        return Plan(experiment, request.seed, given.measured, False, str(request.starts), stem, directories)
    if request.scenarios is None and experiment.starts:
        return Plan(experiment, request.seed, {}, True, "the experiment's own start configurations", stem, directories)
    count = request.scenarios or experiment.scenarios
    experiment = experiment.model_copy(update={"starts": _random_starts(experiment, request.seed, count)})
    source = f"{count} random start configurations of seed {request.seed}"
    return Plan(experiment, request.seed, {}, False, source, f"{stem}-{count}-scenarios", directories)


def check_planner(experiment: ExperimentConfig, where: str) -> None:
    """Raise an error of one line if the mission names a planner that there is not."""
    try:
        check_planner_name(experiment.mission.network.planner)
    except (ValueError, ModuleNotFoundError) as error:
        raise ConfigurationError(f"{where}: mission.network.planner: {error}") from error


def check_coordination(experiment: ExperimentConfig, directories: tuple[Path, ...], where: str) -> None:
    """Raise an error of one line if what the experiment names to serve goals cannot be built or does not exist.

    These are the robot's document, the expert knowledge, its configurations and the scores; strategies are checked as
    they are read.
    """
    library, knowledge = library_of(directories), load_knowledge(experiment.mission.knowledge, directories)
    library.check(knowledge)
    models = coordinators_of(experiment.mission.network, knowledge, library, directories)
    robot_model(experiment.mission.network, models, directories)
    for condition in experiment.conditions:
        try:
            knowledge.with_scores(condition.scores)
        except ValueError as error:
            raise ConfigurationError(f"{where}: condition {condition.name!r}: scores: {error}") from error


def _with_conditions(experiment: ExperimentConfig, chosen: Sequence[str]) -> ExperimentConfig:
    known = [condition.name for condition in experiment.conditions]
    for name in chosen:
        if name not in known:
            raise ConfigurationError(f"{experiment.name}: {unknown('condition', name, known)}")
    conditions = tuple(c for c in experiment.conditions if not chosen or c.name in chosen)
    return experiment.model_copy(update={"conditions": conditions})


def _random_starts(experiment: ExperimentConfig, seed: int, count: int) -> tuple[StartConfiguration, ...]:
    return tuple(random_start(experiment.mission, seed, index) for index in range(count))


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that results depend on."""
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def fingerprints(kinds: Sequence[str], directories: Sequence[Path] = ()) -> dict[str, str]:
    """Return file -> SHA-256 for the files of these kinds: the shipped ones, and those of the user's directories."""
    shipped = configs.directory()
    found = {}
    for root in (shipped, *directories):
        for path in sorted(path for kind in kinds for path in (root / kind).glob("*.yaml")):
            name = (path.relative_to(root) if root == shipped else path).as_posix()
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found
