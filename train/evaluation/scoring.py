"""Scoring: every option of each goal of a family, an experiment or a task is run and gets its scores in a store."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.tasks import OWN_TASK, task_names
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.world.task import task_class
from selector.documents.find import files_of
from selector.documents.reading import read_mapping
from selforg.registry import unknown
from train.deciders.named import FIXED
from train.evaluation.base import Evaluation
from train.evaluation.experiment import ExperimentEvaluation
from train.evaluation.family import FamilyEvaluation
from train.request import Request


def scored_missions(request: Request) -> Sequence[Evaluation]:
    """Return the evaluations that score the options: of an experiment, or one for each goal of a family or a task."""
    name, directories = request.name, request.directories
    families, experiments = (files_of(kind, directories) for kind in ("families", "experiments"))
    path = Path(name).suffix in (".yaml", ".yml")
    if name not in families and (name in experiments or (path and "conditions" in read_mapping(Path(name)))):
        if request.knowledge is not None:
            raise ConfigurationError("--knowledge: expected a family or a task, got an experiment")
        return (ExperimentEvaluation(request),)
    if not path and name not in (*families, *files_of("missions", directories), *task_names()):
        known = dict.fromkeys((*families, *experiments, *task_names()))
        raise ConfigurationError(unknown("family, experiment or task", name, tuple(known)) + OWN_TASK)
    mission = load_family(name, directories).mission
    goals = task_class(mission).goals(mission, directories)
    return [FamilyEvaluation(replace(request, strategies=(FIXED,), goal=goal)) for goal in goals]
