"""`clean-swarm train`: let a policy learn by PPO, or a strategy by the rewards of its choices."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from clean_swarm_env.config.errors import ConfigurationError

app = typer.Typer(no_args_is_help=True, help="Learn which mechanism serves where.")

Config = Annotated[str | None, typer.Option(help="Name of a training, or path to its YAML file.", metavar="NAME|FILE")]
Output = Annotated[Path | None, typer.Option(help="Directory of the training; one below results/ unless given.")]
Seed = Annotated[int, typer.Option(help="Seed of everything random.")]
Resume = Annotated[bool, typer.Option("--resume", help="Go on from the last checkpoint in the directory.")]
Configs = Annotated[
    list[Path] | None,
    typer.Option(help="Directory of your own configurations, searched before the shipped ones; can be repeated."),
]


@app.command()
def ppo(
    config: Config = None, output: Output = None, seed: Seed = 0, resume: Resume = False, configs: Configs = None
) -> None:
    """Train a policy by PPO and export it."""
    _train("ppo", config, output, seed, resume, None, configs)


@app.command()
def bandit(
    config: Config = None,
    output: Output = None,
    seed: Seed = 0,
    resume: Resume = False,
    store: Annotated[
        str | None, typer.Option(help="URL or file of a knowledge store that gets the learned scores.", metavar="URL")
    ] = None,
    configs: Configs = None,
) -> None:
    """Let a strategy learn from the rewards that follow its choices and save what it learned."""
    _train("bandit", config, output, seed, resume, store, configs)


def _train(
    learner: str, config: str | None, output: Path | None, seed: int, resume: bool, store: str | None,
    configs: list[Path] | None,
) -> None:  # fmt: skip
    if seed < 0:
        raise ConfigurationError(f"--seed: expected a whole number of at least 0, got {seed}")
    from selector.documents.errors import DocumentError
    from train.learning.training import DEFAULTS, TrainingRequest, train

    request = TrainingRequest(learner, config or DEFAULTS[learner], seed, output, resume, store, tuple(configs or ()))
    try:
        raise typer.Exit(train(request, Console(highlight=False)))
    except (DocumentError, ValueError) as error:
        raise ConfigurationError(str(error)) from error
