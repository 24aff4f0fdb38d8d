"""`clean-swarm train`: learn by PPO, from the rewards of choices, or from the costs of missions."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer
from rich.console import Console

from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.plain import short
from train.cli.listing import check_named
from train.cli.options import (
    KEEPING,
    GivenOptions,
    asking,
)

if TYPE_CHECKING:
    from train.learning.training import Training, TrainingJob
    from train.reports.results import HeldResults
    from train.request import Request

app = typer.Typer(no_args_is_help=True, help="Learn which mechanism serves where.")

Config = Annotated[str, typer.Option(help="Name of a training, or path to its YAML file.", metavar="NAME|FILE")]
MOST_SEEDS = 100
SPAN = r"\d{1,18}(-\d{1,18})?"
"""A seed, or the first and the last of some."""
ALONE = ("seed", "output", "resume", "force", "configs")
"""Options of trainings in one process."""


@app.command()
@asking(*ALONE, "on", "threads", "store", "learn")
def ppo(
    config: Config = "exploring-ppo",
    seeds: Annotated[
        str, typer.Option(help="Train with these seeds side by side, in place of --seed: 1-10, or 1,4,7.")
    ] = "",
    *,
    given: GivenOptions,
) -> None:
    """Train a policy by PPO and export it."""
    several = seeds_of(seeds) if seeds else []
    if several and given.values["store"]:
        raise ConfigurationError("--store: expected none with --seeds, whose trainings would begin with one another's")
    if given.values["on"] is not None and not several:
        raise ConfigurationError("--on: expected --seeds with it, since one training is one process")
    check_named(given.directories, training=config)
    from train.learning.session import check_installed

    check_installed("ppo")
    if several:
        _train_seeds(several, given.request(config), Path(f"{Path(config).stem}-ppo-seeds{seeds}"))
    from train.learning.ppo.training import PpoTraining  # imports torch

    _train("ppo", config, given, PpoTraining)


@app.command()
@asking(*ALONE, "store", "learn")
def bandit(config: Config, *, given: GivenOptions) -> None:
    """Train a strategy by the rewards that follow its choices and save what it learned."""
    check_named(given.directories, training=config)
    from train.learning.bandit import BanditTraining  # imports Numba

    _train("bandit", config, given, BanditTraining)


@app.command()
@asking("seed", *KEEPING)
def es(config: Config = "es", *, given: GivenOptions) -> None:
    """Train a linear policy by evolution strategies on the costs of whole missions, and export it."""
    check_named(given.directories, training=config)
    from train.learning.es import EsTraining  # imports Numba

    _train("es", config, given, EsTraining)


@app.command()
@asking("seed", *KEEPING)
def design(config: Config = "design", *, given: GivenOptions) -> None:
    """Design a finite state machine by iterated races on the costs of whole missions, and export it."""
    check_named(given.directories, training=config)
    from train.learning.design import DesignTraining  # imports Numba

    _train("design", config, given, DesignTraining)


def _train(learner: str, config: str, given: GivenOptions, made: "Callable[[TrainingJob], Training]") -> None:
    """Train, and exit with the code; a ValueError of a training becomes an error of one line for the user."""
    from train.learning.session import run_training

    try:
        console, request = Console(highlight=False, emoji=False), given.request(config)
        code = run_training(learner, request, made, console, lambda training: _conclude(training, console))
    except ValueError as error:
        raise ConfigurationError(str(error)) from error
    raise typer.Exit(code)


def seeds_of(text: str) -> list[int]:
    """Return the seeds that a text names, such as 1-10 or 1,4,7."""
    found: list[int] = []
    if re.fullmatch(f"{SPAN}(,{SPAN})*", text, re.ASCII):
        spans = [one.partition("-") for one in text.split(",")]
        every = chain.from_iterable(range(int(first), int(last or first) + 1) for first, _, last in spans)
        found = list(islice(every, MOST_SEEDS + 1))
    if not 0 < len(set(found)) == len(found) <= MOST_SEEDS:
        expected = f"expected up to {MOST_SEEDS} different seeds, as in 1-10 or 1,4,7"
        raise ConfigurationError(f"--seeds: {expected}, got {short(text)}")
    return found


def _train_seeds(seeds: Sequence[int], request: "Request", directory: Path) -> NoReturn:
    """Train with each seed, print what they have in common, draw one curve, and exit with the code."""
    from clean_swarm_env.learning.warm_up import usable_cpus
    from train.learning.seeds import trained
    from train.reports.curves import write_curves
    from train.reports.results import results_in
    from train.running.commands import FINISHED, progress
    from train.running.engine import WorkerLost

    root, console = request.output or Path("results") / directory, Console(highlight=False, emoji=False)
    folders = {seed: root / f"seed-{seed}" for seed in seeds}
    for folder in folders.values():
        if not request.resume and folder.is_dir() and any(folder.iterdir()):
            raise ConfigurationError(f"{folder}: has results already; give --resume or another --output")
    workers = max(usable_cpus() // request.machine.threads, 1)
    try:
        with progress("trainings", len(seeds)) as update:
            for seed in trained(replace(request, machine=replace(request.machine, workers=workers)), folders):
                console.print(f"trained: {folders[seed]}", soft_wrap=True)
                update(advance=1)
    except (KeyboardInterrupt, WorkerLost) as end:
        raise typer.Exit(request.ended(end, root, ": trainings are kept")) from end
    except ValueError as error:
        raise ConfigurationError(str(error)) from error
    results = [results_in(folder) for folder in folders.values()]
    console.print(summary_of(results), soft_wrap=True)
    write_curves(results, root)
    raise typer.Exit(FINISHED)


def summary_of(results: "Sequence[HeldResults]") -> str:
    """Return what trainings of several seeds lose on validation, with intervals over seeds and scenarios."""
    import numpy as np

    from train.analysis.intervals import Estimate, Ratio
    from train.analysis.verdict import amount, interval_words

    held = [one.validation for one in results if one.validation is not None]
    excess = np.array([np.concatenate(list(one.learned.values())) for one in held])  # (seeds, scenarios)
    mean = Estimate.of(excess)
    ratio = Ratio.of(excess, np.concatenate(list(held[0].yardstick.values())))
    lost = f"excess {amount(mean.value)} s a validation mission{interval_words(mean.ci95, amount)}"
    times = (
        "" if ratio.ratio is None else f", {ratio.ratio:.2f}{interval_words(ratio.ci95, '{:.2f}'.format)} times that"
    )
    beside = f"{times} of {held[0].held}" if times else ""
    return f"{results[0].name}, {len(held)} seeds: {lost}{beside}"


def _conclude(training: "Training", console: Console) -> None:
    """Print what the training gained on its validation missions, and draw its curves."""
    from train.reports.curves import verdict_of, write_curves
    from train.reports.results import results_in

    for line in verdict_of(training.validation) if training.validation is not None else ():
        console.print(line, soft_wrap=True)
    write_curves([results_in(training.job.folder.path)], training.job.folder.path)
