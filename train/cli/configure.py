"""`clean-swarm configure`: a study of all numbers and flags of one option."""

from typing import Annotated

import typer

from train.cli.options import (
    AnyBits,
    Configs,
    Force,
    OnPlace,
    OtherKnowledge,
    Output,
    Resume,
    Seed,
    Workers,
    check_named,
    check_whole,
)
from train.cli.tune import GivenStore, Storage, check_numbers, run_given

MOST_TRIALS = 100_000


def configure_command(
    option: Annotated[str, typer.Argument(help="Name of an option of the expert knowledge.", metavar="OPTION")],
    family: Annotated[str, typer.Option(help="Family of scenarios, by name or by path.")],
    knowledge: OtherKnowledge = None,
    method: Annotated[str, typer.Option(help="random, TPE, CMA-ES, NSGA-II or MAP-Elites.")] = "TPE",
    trials: Annotated[int, typer.Option(help="Candidates of each method.")] = 60,
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
    """Configure an option for a family: a study of all its numbers and flags, from a quarter to four times each."""
    check_whole({"--trials": (trials, 2, MOST_TRIALS)})
    check_named(configs, families=family, knowledge=knowledge)
    check_numbers(seed, workers)
    from train.running.command import command_words
    from train.running.needs import Machine
    from train.running.runs import usable_cpus
    from train.studies.configured import configured_study

    directories = tuple(configs or ())
    study = configured_study(option, family, knowledge, {"method": method, "trials": trials}, directories)
    command = command_words("configure", option, family=family, method=method, trials=trials, knowledge=knowledge)[1:]
    run_given(
        study,
        tuple(command),
        directories,
        seed=seed,
        output=output,
        resume=resume,
        storage=storage,
        store=store,
        machine=Machine(workers or usable_cpus(), force, on),
        any_bits=any_bits,
    )
