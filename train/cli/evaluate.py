"""`clean-swarm evaluate`: an experiment under its conditions, or strategies on a mission, a family or a task."""

from pathlib import Path
from typing import Annotated

import typer

from selector.documents.plain import DocumentError as ConfigurationError
from train.cli.listing import check_named
from train.cli.options import REPORTING, GivenOptions, asking, check_there, check_whole, wide_console

MOST_WORLD_SEEDS = 100


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
    check_named(given.directories, name=name, knowledge=values["knowledge"])
    check_there(starts)
    from train.evaluation import pipeline  # these import Numba
    from train.evaluation.comparing import Comparing

    chosen = {"strategies": tuple(strategy or ()), "conditions": tuple(condition or ())}
    evaluation = Comparing(given.request(name, **chosen, worlds=world_seeds, starts=starts))
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))
