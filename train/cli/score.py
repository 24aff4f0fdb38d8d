"""`clean-swarm study score`: run the options of goals, and keep what they cost in a knowledge store."""

from typing import Annotated

import typer

from clean_swarm_env.config.types import ConfigurationError
from train.cli.options import KEEPING, GivenOptions, asking, wide_console
from train.running.exit_codes import FINISHED

Names = Annotated[
    list[str],
    typer.Argument(
        help="Families, experiments or tasks; a name is looked for in this order, a path is that of a family or an "
        "experiment.",
        metavar="FAMILY|EXPERIMENT|TASK...",
    ),
]


@asking("scenarios", "seed", "knowledge", "share", *KEEPING)
def score_command(
    names: Names,
    store: Annotated[
        str | None,
        typer.Option(help="URL or file of the knowledge store; the one of `learn knowledge` unless given."),
    ] = None,
    *,
    given: GivenOptions,
) -> None:
    """Run every option of each goal on the same scenarios and keep its scores, with their counts and spreads."""
    if given.values["output"] is not None and len(names) > 1:
        raise ConfigurationError(f"--output: expected one name, got {len(names)}")
    from train.evaluation import pipeline  # these import SciPy, Numba and Matplotlib
    from train.evaluation.scoring import scored_missions
    from train.knowledge_store import StoreRequest, store_url

    console, kept = wide_console(), StoreRequest(store_url(store), learn=True)
    for name in names:
        for evaluation in scored_missions(given.request(name, store=kept, scoring=True)):
            code = pipeline.evaluate(evaluation, console)
            if code != FINISHED:
                raise typer.Exit(code)
