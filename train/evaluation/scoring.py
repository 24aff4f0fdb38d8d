"""Scoring: every option of each goal of a family, an experiment or a task is run and gets its scores in a store."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.tasks import task_names
from clean_swarm_env.world.cleaning_robot import goals_of
from selector.documents.find import files_of
from selector.documents.reading import read_mapping
from selforg.registry import unknown
from train.deciders.named import FIXED
from train.evaluation.base import Evaluation
from train.evaluation.experiment import ExperimentEvaluation, ExperimentRequest
from train.evaluation.family import FamilyEvaluation, FamilyRequest
from train.knowledge_store import StoreRequest, store_url
from train.running.needs import ALONE, Machine


@dataclass(frozen=True)
class ScoreRequest:
    """The request of the user."""

    name: str
    """Family, experiment or task, by name or by path."""
    store: str | None
    """URL or path of the knowledge store; that of `clean-swarm knowledge` unless given."""
    scenarios: int | None
    """Missions of each option."""
    seed: int
    knowledge: str | None
    """Expert knowledge in place of that of a family or a task."""
    directories: tuple[Path, ...]
    """The user's own directories of configurations, searched before the shipped one."""
    machine: Machine = ALONE
    """What missions may use."""

    @property
    def kept(self) -> StoreRequest:
        """The store, to which the scores are given."""
        return StoreRequest(store_url(self.store), learn=True)


def scored_missions(request: ScoreRequest) -> Sequence[Evaluation]:
    """Return the evaluations that score the options: of an experiment, or one for each goal of a family or a task."""
    name, directories = request.name, request.directories
    families, experiments = (files_of(kind, directories) for kind in ("families", "experiments"))
    path = Path(name).suffix in (".yaml", ".yml")
    if name not in families and (name in experiments or (path and "conditions" in read_mapping(Path(name)))):
        if request.knowledge is not None:
            raise ConfigurationError("--knowledge: expected a family or a task, got an experiment")
        wanted = ExperimentRequest(name, request.seed, request.scenarios, directories=directories, store=request.kept)
        return (ExperimentEvaluation(replace(wanted, scoring=True, machine=request.machine)),)
    if not path and name not in (*families, *files_of("missions", directories), *task_names()):
        known = dict.fromkeys((*families, *experiments, *task_names()))
        raise ConfigurationError(unknown("family, experiment or task", name, tuple(known)))
    mission = load_family(name, directories).mission
    of_family = FamilyRequest(name, (FIXED,), request.seed, request.scenarios, request.knowledge)
    of_family = replace(of_family, machine=request.machine, scoring=True)
    return [
        FamilyEvaluation(replace(of_family, goal=goal, directories=directories, store=request.kept))
        for goal in goals_of(mission, directories)
    ]
