"""Evaluations rebuilt from a manifest, to gather their shares: nothing in it is run, imported or connected to."""

from dataclasses import replace
from pathlib import Path

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import RobustnessConfig
from selector.documents.errors import validated
from train.deciders.named import FIXED
from train.evaluation.base import Asked, Evaluation
from train.evaluation.choosing.look_ahead import LookAheadEvaluation, LookingAhead
from train.evaluation.choosing.periods import PeriodsEvaluation
from train.evaluation.experiment import ExperimentEvaluation
from train.evaluation.family import FamilyEvaluation
from train.evaluation.identity import Identity
from train.evaluation.robustness import RobustnessEvaluation
from train.knowledge_store import NO_STORE, StoreRequest
from train.request import Request
from train.running.run_folder import ASKED, COMMAND, MANIFEST, WORKERS, read_manifest


def held_evaluation(request: Request, folder: Path) -> Evaluation:
    """Return the evaluation of which a run folder holds runs; the store of the request gets the scores of its options.

    Raises:
        ConfigurationError: a mistake in the manifest.

    """
    path, manifest = folder / MANIFEST, read_manifest(folder)
    asked = validated(Asked, manifest.get(ASKED, {}), f"{path}: {ASKED}")
    words = manifest.get(COMMAND)
    store = StoreRequest(request.store.url, learn=True) if request.store.url and asked.scoring else NO_STORE
    identity = Identity.of(manifest, folder)
    known = replace(
        request,
        name=str(path),
        seed=identity.seed,
        scenarios=asked.scenarios,
        worlds=asked.worlds,
        directories=identity.directories,
        store=store,
        scoring=asked.scoring,
        words=tuple(map(str, words)) if isinstance(words, list) else (),  # they are only shown
    )
    evaluation = _rebuilt(known, identity, asked, folder)
    evaluation.manifest = {key: value for key, value in manifest.items() if key != WORKERS}
    return evaluation


def _rebuilt(request: Request, identity: Identity, asked: Asked, folder: Path) -> Evaluation:
    where = f"{folder / MANIFEST}: identity"
    if not identity.of_family:
        experiment = validated(ExperimentConfig, identity.content("configuration"), f"{where}.configuration")
        return ExperimentEvaluation(replace(request, scenarios=None), experiment, asked)
    family, request = identity.family(folder), replace(request, strategies=(FIXED,), goal=identity.goal)
    evaluation: FamilyEvaluation
    if held := identity.content("look_ahead"):
        return LookAheadEvaluation(request, validated(LookingAhead, held, f"{where}.look_ahead"), family)
    if identity.periods:
        evaluation = PeriodsEvaluation(request, identity.periods, family)
    elif isinstance(family, RobustnessConfig):
        evaluation = RobustnessEvaluation(request, family)
    else:
        evaluation = FamilyEvaluation(request, family)
    evaluation.entrants = identity.entrants
    return evaluation
