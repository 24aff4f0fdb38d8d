"""Gathering: the runs of all shares of an evaluation, checked against each other and against the evaluation.

The evaluation is rebuilt from a manifest: nothing in it is run, imported or connected to.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from clean_swarm_env.config.experiment import ExperimentConfig
from clean_swarm_env.config.types import ConfigurationError
from selector.documents.errors import validated
from train.deciders.named import FIXED
from train.evaluation.base import Asked, Evaluation, Identity
from train.evaluation.experiment import ExperimentEvaluation
from train.evaluation.family import FamilyEvaluation
from train.evaluation.look_ahead import LookAheadEvaluation, LookingAhead
from train.memory import NO_STORE, StoreRequest
from train.request import ALL, Request, RunShare
from train.running.finished_runs import JOURNAL, runs_of
from train.running.run_folder import ASKED, COMMAND, MANIFEST, SHARE_FOLDERS, WORKERS, Json, RunFolder, read_manifest
from train.running.runs import RunKey, RunRecord


def gathered(evaluation: Evaluation, directory: Path, count: int) -> tuple[list[RunRecord], Json]:
    """Return the runs of all shares, and the knowledge of options at their beginning.

    Raises:
        ConfigurationError: a share is not there, is not finished, or is one of another evaluation.

    """
    keys, runs, known = evaluation.keys, dict[RunKey, tuple[RunRecord, Path]](), list[Json]()
    shares = {share: share.folder(directory) for share in (RunShare(k, count) for k in range(1, count + 1))}
    for share, path in shares.items():
        if not (path / MANIFEST).exists():
            raise ConfigurationError(f"{path}: no such share; expected the results of {_command(evaluation, share)}")
        folder = RunFolder(path, evaluation.manifest, resume=True, growing=evaluation.growing)
        with folder.alone():
            for record in runs_of(path / JOURNAL, evaluation.mistake):
                other, first = runs.setdefault(record.key, (record, path))
                if other.result != record.result:
                    run = f"scenario {record.scenario}, condition {record.condition}"
                    raise ConfigurationError(f"{first} and {path}: expected the same figures of {run}, got others")
        known.append(folder.learned)
        if folder.learned != known[0]:
            raise ConfigurationError(f"{path}: began with other learned scores than share 1")
    for share, path in shares.items():
        part = share.part(keys)
        lacking = sum(key not in runs for key in part)
        if lacking:
            how = _command(evaluation, share)
            raise ConfigurationError(f"{path}: lacks {lacking} of {len(part)} runs; to go on: {how}")
    return [record for record, _ in runs.values()], known[0]


def _command(evaluation: Evaluation, share: RunShare) -> str:
    """Return the command of a share: that of a share which is there, in which the last --share counts."""
    asked = evaluation.request
    return f"`{asked.command(asked.output or Path(), '--share', str(share), '--resume')}`"


def first_share(directory: Path) -> tuple[RunShare, Path]:
    """Return what gathers the shares in a directory, and the run folder of the first one that is there."""
    names = [path.name for path in sorted((directory / SHARE_FOLDERS).glob("*-of-*"))]
    counts = sorted({name.rpartition("-")[2] for name in names})
    if len(counts) != 1:
        found = f"shares of {' and of '.join(counts)}" if counts else "none"
        raise ConfigurationError(f"{directory / SHARE_FOLDERS}: expected shares of one number, got {found}")
    return RunShare.of_text(f"{ALL}/{counts[0]}"), directory / SHARE_FOLDERS / names[0]


def held_evaluation(request: Request, folder: Path) -> Evaluation:
    """Return the evaluation of which a run folder holds runs; the store of the request gets the scores of its options.

    Raises:
        ConfigurationError: a mistake in the manifest.

    """
    path, manifest = folder / MANIFEST, read_manifest(folder)
    asked = validated(Asked, manifest.get(ASKED, {}), f"{path}: {ASKED}")
    words = manifest.get(COMMAND)
    store = StoreRequest(request.store.path, learn=True) if request.store.path and asked.scoring else NO_STORE
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
    if held := identity.content("look_ahead"):
        return LookAheadEvaluation(request, validated(LookingAhead, held, f"{where}.look_ahead"), family)
    evaluation = FamilyEvaluation(request, family, identity.periods)
    evaluation.entrants = identity.entrants
    return evaluation
