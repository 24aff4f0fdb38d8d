"""`clean-swarm train`: learn by PPO, from the rewards of choices, or from the mission costs of many members."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from clean_swarm_env.config.errors import ConfigurationError
from train.cli.options import (
    MOST_SEED,
    MOST_WORKERS,
    AnyBits,
    Configs,
    Force,
    Learn,
    OnPlace,
    RunStore,
    Seed,
    Workers,
    check_named,
    check_whole,
)

app = typer.Typer(no_args_is_help=True, help="Learn which mechanism serves where.")

Config = Annotated[str, typer.Option(help="Name of a training, or path to its YAML file.", metavar="NAME|FILE")]
Output = Annotated[Path | None, typer.Option(help="Directory of the training; one below results/ unless given.")]
Resume = Annotated[bool, typer.Option("--resume", help="Go on from the last checkpoint in the directory.")]

RecordOption = Annotated[
    bool, typer.Option("--record", help="Record the missions of validations, for `clean-swarm replay`.")
]


@app.command()
def ppo(
    config: Config = "exploring-ppo",
    output: Output = None,
    seed: Seed = 0,
    resume: Resume = False,
    configs: Configs = None,
    record: RecordOption = False,
    force: Force = False,
) -> None:
    """Train a policy by PPO and export it."""
    check_whole({"--seed": (seed, 0, MOST_SEED)})
    check_named(configs, training=config)
    from train.learning.session import TrainingRequest, check_installed, run_training
    from train.running.needs import Machine

    check_installed("ppo")
    from train.learning.ppo.training import PpoTraining  # imports torch

    directories = tuple(configs or ())
    alone = Machine(forced=force)
    request = TrainingRequest(
        "ppo", config, seed, output, resume, directories=directories, record=record, machine=alone
    )
    with _one_line():
        raise typer.Exit(run_training(request, PpoTraining, Console(highlight=False)))


@app.command()
def bandit(
    config: Config,
    output: Output = None,
    seed: Seed = 0,
    resume: Resume = False,
    store: RunStore = None,
    learn: Learn = False,
    configs: Configs = None,
    record: RecordOption = False,
    force: Force = False,
) -> None:
    """Train a strategy by the rewards that follow its choices and save what it learned."""
    check_whole({"--seed": (seed, 0, MOST_SEED)})
    check_named(configs, training=config)
    from train.knowledge_store import StoreRequest  # these import SQLAlchemy and Numba
    from train.learning.bandit import BanditTraining
    from train.learning.session import TrainingRequest, run_training
    from train.running.needs import Machine

    directories, kept = tuple(configs or ()), StoreRequest(store, learn)
    request = TrainingRequest("bandit", config, seed, output, resume, kept, directories, record, Machine(forced=force))
    with _one_line():
        raise typer.Exit(run_training(request, BanditTraining, Console(highlight=False)))


def _members_command(learner: str, summary: str) -> None:
    """Add the command of a learner whose members do whole missions; its default training has the learner's name."""

    @app.command(learner, help=summary)
    def train(
        config: Config = learner,
        output: Output = None,
        seed: Seed = 0,
        resume: Resume = False,
        workers: Workers = None,
        configs: Configs = None,
        record: RecordOption = False,
        force: Force = False,
        on: OnPlace = None,
        any_bits: AnyBits = False,
    ) -> None:
        check_whole({"--seed": (seed, 0, MOST_SEED), "--workers": (workers, 1, MOST_WORKERS)})
        check_named(configs, training=config)
        from train.cluster.bits import WorkerBits  # these import SQLAlchemy and Numba
        from train.knowledge_store import NO_STORE
        from train.learning.members.design import DesignTraining
        from train.learning.members.es import EsTraining
        from train.learning.session import TrainingRequest, run_training
        from train.running.needs import Machine
        from train.running.runs import usable_cpus

        made = {"es": EsTraining, "design": DesignTraining}[learner]
        machine = Machine(workers or usable_cpus(), force, on)
        asked = (learner, config, seed, output, resume, NO_STORE, tuple(configs or ()), record, machine)
        request = TrainingRequest(*asked, WorkerBits(mixed=any_bits))
        with _one_line():
            raise typer.Exit(run_training(request, made, Console(highlight=False)))


_members_command("es", "Train a linear policy by evolution strategies on the costs of whole missions, and export it.")
_members_command(
    "design", "Design a finite state machine by iterated races on the costs of whole missions, and export it."
)


@contextmanager
def _one_line() -> Iterator[None]:
    """Turn a ValueError of a training into an error of one line for the user."""
    try:
        yield
    except ValueError as error:
        raise ConfigurationError(str(error)) from error
