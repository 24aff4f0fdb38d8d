"""`clean-swarm study score`: run the options of goals, and keep what they cost in a knowledge store."""

from typing import Annotated

import typer

from clean_swarm_env.config.errors import ConfigurationError
from train.cli.options import KEEPING, MOST_SCENARIOS, GivenOptions, asking, check_whole, wide_console
from train.running.exit_codes import FINISHED

Names = Annotated[
    list[str],
    typer.Argument(
        help="Families, experiments or goals; a name is looked for in this order, a path is that of a family or an "
        "experiment.",
        metavar="FAMILY|EXPERIMENT|GOAL...",
    ),
]


@asking("scenarios", "seed", "knowledge", "share", *KEEPING)
def score_command(
    names: Names,
    store: Annotated[
        str | None,
        typer.Option(help="URL or file of the knowledge store; the one of `learn knowledge` unless given."),
    ] = None,
    runs: Annotated[int, typer.Option(help="Runs of each option of a goal in its scene.")] = 20,
    *,
    given: GivenOptions,
) -> None:
    """Run every option of each goal on the same scenarios and keep its scores, with their counts and spreads."""
    check_whole({"--runs": (runs, 1, MOST_SCENARIOS)})
    if given.values["output"] is not None and len(names) > 1:
        raise ConfigurationError(f"--output: expected one name, got {len(names)}")
    from train.evaluation import pipeline  # these import SciPy, Numba and Matplotlib
    from train.evaluation.scoring import score_scene, scored_missions
    from train.knowledge_store import StoreRequest, store_url

    console, kept = wide_console(), StoreRequest(store_url(store), learn=True)
    for name in names:
        request = given.request(name, store=kept, scoring=True)
        evaluations = scored_missions(request)
        if not evaluations:
            if request.share is not None or request.machine.place is not None:
                raise ConfigurationError(f"--share and --on: expected missions, got the scene of {name}, one batch")
            score_scene(request, runs, console)
        for evaluation in evaluations:
            code = pipeline.evaluate(evaluation, console)
            if code != FINISHED:
                raise typer.Exit(code)
