"""Scoring: every option of each goal of a family, an experiment or a scene is run and gets its scores in a store."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.load import load_family
from clean_swarm_env.scenes import goals
from clean_swarm_env.scenes.served import KNOWLEDGE
from selector.coordination.robot_document import coordinated_goals
from selector.documents.find import files_of, find_file
from selector.documents.reading import read_mapping
from selforg.registry import unknown
from train.deciders.named import FIXED
from train.evaluation.base import Evaluation
from train.evaluation.experiment import ExperimentEvaluation
from train.evaluation.family import FamilyEvaluation
from train.goals.scene_runs import GoalRequest, score_goal
from train.reports.knowledge_tables import learned_scores
from train.reports.text_table import on_terminal
from train.request import Request


def scored_missions(request: Request) -> Sequence[Evaluation]:
    """Return the evaluations that score the options of a family, one a goal, or of an experiment; none for a scene."""
    name, directories = request.name, request.directories
    families, experiments = (files_of(kind, directories) for kind in ("families", "experiments"))
    path = Path(name).suffix in (".yaml", ".yml")
    if name not in families and (name in experiments or (path and "conditions" in read_mapping(Path(name)))):
        if request.knowledge is not None:
            raise ConfigurationError("--knowledge: expected a family or a goal, got an experiment")
        return (ExperimentEvaluation(request),)
    if name in families or path:
        robot = load_family(name, directories).mission.network.robot
        decided = coordinated_goals(find_file("robots", robot, directories))
        return [FamilyEvaluation(replace(request, strategies=(FIXED,), goal=goal)) for goal in decided]
    if name in goals():
        return ()
    known = (*families, *experiments, *goals())
    raise ConfigurationError(unknown("family, experiment or goal", name, tuple(dict.fromkeys(known))))


def score_scene(request: Request, runs: int, console: Console) -> None:
    """Score the options of a goal in its scene, each in some `runs`, and print them."""
    of_goal = GoalRequest(request.name, seed=request.seed, runs=runs, directories=request.directories)
    of_goal = replace(of_goal, knowledge=request.knowledge or KNOWLEDGE, store=request.store)
    memory = of_goal.memory()
    assert memory is not None
    score_goal(of_goal, memory)
    console.print(on_terminal(learned_scores(memory.now(), f"known now in the context {memory.context!r}")))
    memory.close()
