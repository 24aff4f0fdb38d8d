"""`clean-swarm train`: learn by PPO, from the rewards of choices, or from the mission costs of many members."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import KEEPING, GivenOptions, asking, check_named

if TYPE_CHECKING:  # imports Numba
    from train.learning.training import Training, TrainingJob

app = typer.Typer(no_args_is_help=True, help="Learn which mechanism serves where.")

Config = Annotated[str, typer.Option(help="Name of a training, or path to its YAML file.", metavar="NAME|FILE")]
ALONE = ("seed", "output", "resume", "record", "force", "configs")
"""GivenOptions of trainings in one process."""


@app.command()
@asking(*ALONE)
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
    from train.learning.bandit import BanditTraining  # imports SQLAlchemy and Numba

    _train("bandit", config, given, BanditTraining)


@app.command()
@asking("seed", "record", *KEEPING)
def es(config: Config = "es", *, given: GivenOptions) -> None:
    """Train a linear policy by evolution strategies on the costs of whole missions, and export it."""
    check_named(given.directories, training=config)
    from train.learning.members.es import EsTraining  # imports Numba

    _train("es", config, given, EsTraining)


@app.command()
@asking("seed", "record", *KEEPING)
def design(config: Config = "design", *, given: GivenOptions) -> None:
    """Design a finite state machine by iterated races on the costs of whole missions, and export it."""
    check_named(given.directories, training=config)
    from train.learning.members.design import DesignTraining  # imports Numba

    _train("design", config, given, DesignTraining)


def _train(learner: str, config: str, given: GivenOptions, made: "Callable[[TrainingJob], Training]") -> None:
    """Train, and exit with the code; a ValueError of a training becomes an error of one line for the user."""
    from train.learning.session import run_training

    try:
        code = run_training(learner, given.request(config), made, Console(highlight=False))
    except ValueError as error:
        raise ConfigurationError(str(error)) from error
    raise typer.Exit(code)
