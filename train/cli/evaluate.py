"""`clean-swarm evaluate`: an experiment under all its conditions, or strategies on a family of scenarios."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import KEEPING, GivenOptions, asking, check_named, check_whole, wide_console

MOST_WORLD_SEEDS = 100


@asking("scenarios", "seed", "knowledge", "goal", "store", "learn", "record", "minds", "share", *KEEPING)
def evaluate_command(
    experiment: Annotated[str, typer.Argument(help="Name of an experiment, or path to its YAML file.")] = "table1",
    starts: Annotated[Path | None, typer.Option(help="JSON file of start configurations to run on.")] = None,
    condition: Annotated[list[str] | None, typer.Option(help="Run this condition only; can be repeated.")] = None,
    family: Annotated[
        str | None, typer.Option(help="Compare strategies on scenarios of this family, by name or path.")
    ] = None,
    strategy: Annotated[
        list[str] | None,
        typer.Option(
            help="With --family: fixed (every option; the default), fixed:OPTION, fsm:NAME, policy:NAME, policy:FILE "
            "(a directory, .zip of Stable-Baselines3, .pt of TorchScript or .onnx), velocity:FILE (a model that "
            "drives), learned:NAME, learned:FILE, STRATEGY, STRATEGY:parameter=value or module:Class of your own; + "
            "joins what several training seeds gave, LABEL=... names it; can be repeated; Off and Random come beside.",
        ),
    ] = None,
    world_seeds: Annotated[
        int, typer.Option(help="With --family: world seeds of each scenario; the oracle needs two or more.")
    ] = 1,
    *,
    given: GivenOptions,
) -> None:
    """Run an experiment under all its conditions, or strategies on a family; the default is the paper's Table 1."""
    values = given.values
    check_whole({"--world-seeds": (world_seeds, 1, MOST_WORLD_SEEDS)})
    if values["learn"] and values["workers"] not in (None, 1):
        expected = "expected 1 with --learn, where missions learn in turn"
        raise ConfigurationError(f"--workers: {expected}, got {values['workers']}")
    of_family = {"--knowledge": values["knowledge"], "--goal": values["goal"], "--world-seeds": world_seeds > 1}
    if family is None:
        check_named(given.directories, experiments=experiment)
        _check_absent("with --family", {"--strategy": strategy, **of_family})
    else:
        _check_absent("without --family", {"--starts": starts, "--condition": condition})
        check_named(given.directories, strategy, families=family, knowledge=values["knowledge"])
    from clean_swarm_env.config.load import load_robustness  # these import SciPy, Numba and Matplotlib
    from train.evaluation import pipeline
    from train.evaluation.base import Evaluation
    from train.evaluation.experiment import ExperimentEvaluation
    from train.evaluation.family import FamilyEvaluation

    evaluation: Evaluation
    if family is not None:
        strategies = tuple(strategy or ("fixed",))
        evaluation = FamilyEvaluation(given.request(family, strategies=strategies, worlds=world_seeds))
    elif (robustness := load_robustness(experiment, given.directories)) is not None:
        unused = {"--starts": starts, "--condition": condition, "--store": values["store"], "--learn": values["learn"]}
        _check_absent("with experiments without disturbances", unused)
        evaluation = FamilyEvaluation(given.request(experiment, strategies=robustness.strategies), robustness)
    else:
        evaluation = ExperimentEvaluation(given.request(experiment, starts=starts, conditions=tuple(condition or ())))
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))


def _check_absent(where: str, given: Mapping[str, object]) -> None:
    for name, value in given.items():
        if value:
            raise ConfigurationError(f"{name}: expected {where} only")
