"""Scoring: every option of each goal of a family, an experiment or a scene is run and gets its scores in a store."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
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
from train.evaluation.experiment import ExperimentEvaluation, ExperimentRequest
from train.evaluation.family import FamilyEvaluation, FamilyRequest
from train.goals.scene_runs import GoalRequest, score_goal
from train.knowledge_store import StoreRequest, store_url
from train.reports.knowledge_tables import learned_scores
from train.reports.text_table import on_terminal
from train.running.needs import ALONE, Machine


@dataclass(frozen=True)
class ScoreRequest:
    """The request of the user."""

    name: str
    """Family, experiment or goal, by name or by path."""
    store: str | None
    """URL or path of the knowledge store; that of `clean-swarm knowledge` unless given."""
    scenarios: int | None
    """Missions of each option."""
    runs: int
    """Runs of each option of a goal in its scene."""
    seed: int
    knowledge: str | None
    """Expert knowledge in place of that of a family or goal."""
    directories: tuple[Path, ...]
    """The user's own directories of configurations, searched before the shipped one."""
    machine: Machine = ALONE
    """What missions may use."""

    @property
    def kept(self) -> StoreRequest:
        """The store, to which the scores are given."""
        return StoreRequest(store_url(self.store), learn=True)


def scored_missions(request: ScoreRequest) -> Sequence[Evaluation]:
    """Return the evaluations that score the options of a family, one a goal, or of an experiment; none for a scene."""
    name, directories = request.name, request.directories
    families, experiments = (files_of(kind, directories) for kind in ("families", "experiments"))
    path = Path(name).suffix in (".yaml", ".yml")
    if name in experiments or (path and "conditions" in read_mapping(Path(name))):
        kind = "experiment" if name not in families else "family"
    elif name in families or path:
        kind = "family"
    elif name in goals():
        return ()
    else:
        known = (*families, *experiments, *goals())
        raise ConfigurationError(unknown("family, experiment or goal", name, tuple(dict.fromkeys(known))))
    if kind == "experiment":
        if request.knowledge is not None:
            raise ConfigurationError("--knowledge: expected a family or a goal, got an experiment")
        wanted = ExperimentRequest(name, request.seed, request.scenarios, directories=directories, store=request.kept)
        return (ExperimentEvaluation(replace(wanted, scoring=True, machine=request.machine)),)
    robot = load_family(name, directories).mission.network.robot
    of_family = FamilyRequest(name, (FIXED,), request.seed, request.scenarios, request.knowledge)
    of_family = replace(of_family, machine=request.machine, scoring=True)
    return [
        FamilyEvaluation(replace(of_family, goal=goal, directories=directories, store=request.kept))
        for goal in coordinated_goals(find_file("robots", robot, directories))
    ]


def score_scene(request: ScoreRequest, console: Console) -> None:
    """Score the options of a goal in its scene and print them."""
    of_goal = GoalRequest(request.name, seed=request.seed, runs=request.runs, directories=request.directories)
    of_goal = replace(of_goal, knowledge=request.knowledge or KNOWLEDGE, store=request.kept)
    memory = of_goal.memory()
    assert memory is not None
    score_goal(of_goal, memory)
    console.print(on_terminal(learned_scores(memory.now(), f"known now in the context {memory.context!r}")))
    memory.close()
