"""Evaluations rebuilt from a manifest, to gather their shares: nothing in it is run, imported or connected to."""

from dataclasses import replace
from pathlib import Path

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.families import RobustnessConfig
from selector.documents.errors import validated
from train.deciders.named import FIXED
from train.evaluation.base import Asked, Evaluation
from train.evaluation.experiment import ExperimentEvaluation, ExperimentRequest
from train.evaluation.family import FamilyEvaluation, FamilyRequest
from train.evaluation.repeat import held_directories
from train.evaluation.repeat_trial import evaluation_seed, held_entrants, held_family
from train.evaluation.robustness import RobustnessEvaluation
from train.knowledge_store import NO_STORE, StoreRequest
from train.running.needs import Machine
from train.running.run_folder import ASKED, COMMAND, MANIFEST, WORKERS, Json, read_manifest


def held_evaluation(folder: Path, store: str | None) -> Evaluation:
    """Return the evaluation of which a run folder holds runs; a `store` gets the scores of its options.

    Raises:
        ConfigurationError: a mistake in the manifest.

    """
    path, manifest = folder / MANIFEST, read_manifest(folder)
    asked = validated(Asked, manifest.get(ASKED, {}), f"{path}: {ASKED}")
    evaluation = _rebuilt(
        manifest, asked, path, StoreRequest(store, learn=True) if store and asked.scoring else NO_STORE
    )
    if isinstance(words := manifest.get(COMMAND), list):
        evaluation.words = [str(word) for word in words]  # they are only shown
    evaluation.manifest = {key: value for key, value in manifest.items() if key != WORKERS}
    return evaluation


def _rebuilt(manifest: Json, asked: Asked, path: Path, store: StoreRequest) -> Evaluation:
    identity, directories = manifest["identity"], held_directories(manifest, path)
    seed, name = evaluation_seed(identity, path), str(path)
    if "family" not in identity:
        experiment = validated(ExperimentConfig, identity.get("configuration"), f"{path}: identity.configuration")
        known = ExperimentRequest(name, seed, directories=directories, store=store, scoring=asked.scoring)
        return ExperimentEvaluation(replace(known, machine=Machine(forced=True)), experiment, asked)
    entrants = [entrant for entrant, _ in held_entrants(identity.get("strategies"), path)]
    family = held_family(identity["family"], [one.label for one in entrants], f"{path}: identity.family")
    request = FamilyRequest(
        family=name,
        strategies=(FIXED,),
        seed=seed,
        scenarios=asked.scenarios,
        goal=str(identity.get("goal")),
        directories=directories,
        store=store,
        scoring=asked.scoring,
        machine=Machine(forced=True),
        worlds=asked.worlds,
    )
    evaluation: FamilyEvaluation = (
        RobustnessEvaluation(request, family)
        if isinstance(family, RobustnessConfig)
        else FamilyEvaluation(request, family)
    )
    evaluation.entrants = entrants
    return evaluation
