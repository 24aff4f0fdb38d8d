"""`clean-swarm train`: learn by PPO, from the rewards of choices, or from the costs of missions."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from selector.documents.plain import DocumentError as ConfigurationError
from train.cli.listing import check_named
from train.cli.options import (
    KEEPING,
    GivenOptions,
    asking,
)

if TYPE_CHECKING:
    from train.learning.training import Training, TrainingJob
    from train.request import Request

app = typer.Typer(no_args_is_help=True, help="Learn which mechanism serves where.")

Config = Annotated[str, typer.Option(help="Name of a training, or path to its YAML file.", metavar="NAME|FILE")]
ALONE = ("seed", "output", "resume", "figure", "force", "configs")
"""Options of trainings in one process."""


@app.command()
@asking(*ALONE, "threads", "store", "learn")
def ppo(config: Config = "exploring-ppo", *, given: GivenOptions) -> None:
    """Train a policy by PPO and export it."""
    check_named(given.directories, training=config)
    from train.learning.session import check_installed

    check_installed("ppo")
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
@asking("seed", "figure", *KEEPING)
def es(config: Config = "es", *, given: GivenOptions) -> None:
    """Train a linear policy by evolution strategies on the costs of whole missions, and export it."""
    check_named(given.directories, training=config)
    from train.learning.es import EsTraining  # imports Numba

    _train("es", config, given, EsTraining)


@app.command()
@asking("seed", "figure", *KEEPING)
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
        code = run_training(learner, request, made, console, lambda training: _conclude(training, request, console))
    except ValueError as error:
        raise ConfigurationError(str(error)) from error
    raise typer.Exit(code)


def _conclude(training: "Training", request: "Request", console: Console) -> None:
    """Print what the training gained on its validation missions, and draw its curves where the user wants them."""
    from train.reports.curves import Trained, draw_curves, verdict_of
    from train.reports.text_table import write_figure

    for line in verdict_of(training.validation) if training.validation is not None else ():
        console.print(line, soft_wrap=True)
    curves = Trained(training.config.name, training.history, training.validation)
    write_figure(draw_curves([curves]) if request.figure is not None else None, request.figure, console)
