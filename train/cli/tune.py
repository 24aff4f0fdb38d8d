"""`clean-swarm tune`: search for parameters of options by missions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from train.cli.options import (
    MOST_SEED,
    MOST_WORKERS,
    AnyBits,
    Configs,
    Force,
    OnPlace,
    Output,
    Resume,
    Seed,
    Workers,
    check_named,
    check_whole,
    wide_console,
)

if TYPE_CHECKING:  # imports pydantic, NumPy and Numba
    from train.running.needs import Machine
    from train.studies.config import StudyConfig

Storage = Annotated[
    str | None,
    typer.Option(
        help="Where optuna's tools find the trials: sqlite:///PATH, postgresql://..., or journal:PATH on a network "
        "drive; a file in the directory of the results unless given.",
        metavar="URL",
    ),
]
GivenStore = Annotated[
    str | None, typer.Option(help="Knowledge store that gets the result, with the study as its source.", metavar="URL")
]


def tune_command(
    study: Annotated[str, typer.Argument(help="Name of a study, or path to its YAML file.", metavar="STUDY")],
    seed: Seed = 0,
    output: Output = None,
    resume: Resume = False,
    workers: Workers = None,
    storage: Storage = None,
    store: GivenStore = None,
    force: Force = False,
    on: OnPlace = None,
    any_bits: AnyBits = False,
    configs: Configs = None,
) -> None:
    """Search for parameters and scores of options by missions; a last race on fresh training scenarios decides."""
    check_named(configs, studies=study)
    check_numbers(seed, workers)
    from train.running.needs import Machine
    from train.running.runs import usable_cpus
    from train.studies.config import load_study

    run_given(
        load_study(study, configs or ()),
        ("tune", study),
        tuple(configs or ()),
        seed=seed,
        output=output,
        resume=resume,
        storage=storage,
        store=store,
        machine=Machine(workers or usable_cpus(), force, on),
        any_bits=any_bits,
    )


def check_numbers(seed: int, workers: int | None) -> None:
    """Raise an error of one line for numbers out of bounds, and for missing packages."""
    check_whole({"--workers": (workers, 1, MOST_WORKERS), "--seed": (seed, 0, MOST_SEED)})
    from train.studies.installation import study_versions

    study_versions()


def run_given(
    study: StudyConfig,
    command: tuple[str, ...],
    directories: tuple[Path, ...],
    *,
    seed: int,
    output: Path | None,
    resume: bool,
    storage: str | None,
    store: str | None,
    machine: Machine,
    any_bits: bool,
) -> None:
    """Run a study and exit with its code; `command` are the words that lead to the study."""
    from train.cluster.bits import WorkerBits  # these import Numba, SQLAlchemy and optuna
    from train.knowledge_store import StoreRequest
    from train.studies.study import StudyRequest, run_study

    request = StudyRequest(
        study,
        command,
        seed,
        output,
        resume,
        storage,
        StoreRequest(store, learn=store is not None),
        directories,
        machine,
        WorkerBits(mixed=any_bits),
    )
    raise typer.Exit(run_study(request, wide_console()))
