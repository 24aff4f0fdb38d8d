"""`clean-swarm evaluate`: an experiment under its conditions, or strategies on a mission, a family or a task."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from clean_swarm_env.config.task_names import named_file
from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.reading import read_mapping
from selforg.registry import unknown
from train.cli.listing import check_named, conditions_in
from train.cli.options import REPORTING, GivenOptions, asking, check_there, check_whole, wide_console

MOST_WORLD_SEEDS = 100
OF_EXPERIMENTS = {"conditions", "disturbances", "strategies"}
"""Keys by which the file of an experiment is told from that of a mission or a family."""


@asking("scenarios", "seed", "knowledge", "goal", "store", "learn", "record", "minds", *REPORTING)
def evaluate_command(
    name: Annotated[
        str,
        typer.Argument(
            help="A name, or path to a YAML file.",
            metavar="[EXPERIMENT|MISSION|FAMILY|TASK]",
        ),
    ] = "table1",
    starts: Annotated[
        Path | None, typer.Option(help="JSON file of start configurations of an experiment.", metavar="FILE")
    ] = None,
    condition: Annotated[
        list[str] | None, typer.Option(help="Run this condition of an experiment only; can be repeated.")
    ] = None,
    strategy: Annotated[
        list[str] | None,
        typer.Option(
            help="fixed (every option; usual without an experiment), fixed:OPTION, fsm:NAME, policy:NAME|FILE, "
            "learned:NAME, velocity:FILE, NAME[:parameter=value] (docs/strategies.md); LABEL=... names it, + joins "
            "seeds; can be repeated.",
        ),
    ] = None,
    world_seeds: Annotated[
        int, typer.Option(help="World seeds of each scenario of strategies; the oracle needs two or more.")
    ] = 1,
    *,
    given: GivenOptions,
) -> None:
    """Run an experiment under all its conditions, or compare strategies; the default is the paper's Table 1.

    Of a name that is both, the experiment is run unless a strategy is given.
    """
    values = given.values
    check_whole({"--world-seeds": (world_seeds, 1, MOST_WORLD_SEEDS)})
    if values["learn"] and values["workers"] not in (None, 1):
        expected = "expected 1 with --learn, where missions learn in turn"
        raise ConfigurationError(f"--workers: {expected}, got {values['workers']}")
    compared = strategy or values["knowledge"] or world_seeds > 1
    path = (
        None
        if compared or Path(name).is_dir()
        else named_file(name, given.directories, kinds=("experiments", "missions", "families"))
    )
    of_experiments = {"--starts": starts, "--condition": condition}
    if path is None or not OF_EXPERIMENTS & read_mapping(path).keys():
        _check_absent("with an experiment, and no strategies,", of_experiments)
        check_named(given.directories, strategy, name=name, knowledge=values["knowledge"])
        path = None
    elif condition and (known := conditions_in(path)):
        for one in condition:
            if one not in known:
                raise ConfigurationError(f"{Path(name).stem}: {unknown('condition', one, known)}")
    check_there(starts)
    from clean_swarm_env.config.load import load_robustness  # these import Numba
    from train.evaluation import pipeline
    from train.evaluation.base import Evaluation
    from train.evaluation.experiment import ExperimentEvaluation
    from train.evaluation.family import FamilyEvaluation

    evaluation: Evaluation
    if path is None:
        strategies = tuple(strategy or ("fixed",))
        evaluation = FamilyEvaluation(given.request(name, strategies=strategies, worlds=world_seeds))
    elif (robustness := load_robustness(name, given.directories)) is not None:
        unused = {**of_experiments, "--store": values["store"], "--learn": values["learn"]}
        _check_absent("with experiments without disturbances", unused)
        evaluation = FamilyEvaluation(given.request(name, strategies=robustness.strategies), robustness)
    else:
        _check_absent("with strategies, or an experiment with disturbances", {"--goal": values["goal"]})
        evaluation = ExperimentEvaluation(given.request(name, starts=starts, conditions=tuple(condition or ())))
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))


def _check_absent(where: str, given: Mapping[str, object]) -> None:
    for name, value in given.items():
        if value:
            raise ConfigurationError(f"{name}: expected {where} only")
