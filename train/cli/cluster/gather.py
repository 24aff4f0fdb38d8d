"""`clean-swarm gather`: merge the results of the shares of an evaluation."""

from pathlib import Path
from typing import Annotated

import typer

from train.cli.options import MAY_NAME_CODE, AnyBits, error_console, wide_console


def gather_command(
    directory: Annotated[Path, typer.Argument(help=f"The --output of the shares; {MAY_NAME_CODE}.", metavar="DIR")],
    store: Annotated[
        str | None, typer.Option(help="Knowledge store, by URL or path, that gets the scores of shares of `score`.")
    ] = None,
    any_bits: AnyBits = False,
) -> None:
    """Merge the results of all shares, as if one command had done all runs: runs, tables, figure."""
    from train.cluster.bits import WorkerBits
    from train.evaluation import pipeline  # imports SciPy, Numba and Matplotlib
    from train.evaluation.gathering import first_share
    from train.evaluation.held import held_evaluation
    from train.knowledge_store import StoreRequest
    from train.request import Request
    from train.running.needs import Machine

    share, folder = first_share(directory)
    request = Request(
        str(directory),
        output=directory,
        resume=True,
        share=share,
        store=StoreRequest(store),
        machine=Machine(forced=True),
        bits=WorkerBits(mixed=any_bits),
    )
    evaluation = held_evaluation(request, folder)
    if evaluation.scored and store is None:
        error_console().print("the scores reach no store; `gather --store URL` gives them to one", markup=False)
    raise typer.Exit(pipeline.evaluate(evaluation, wide_console()))
