"""`clean-swarm gather`: merge the results of the shares of an evaluation."""

from pathlib import Path
from typing import Annotated

import typer

from train.cli.options import AnyBits, error_console, wide_console


def gather_command(
    directory: Annotated[Path, typer.Argument(help="The --output of the shares.", metavar="DIR")],
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
    from train.running.processes import Processes

    share, folder = first_share(directory)
    evaluation = held_evaluation(folder, store)
    if evaluation.scored and store is None:
        error_console().print("the scores reach no store; `gather --store URL` gives them to one", markup=False)
    execution = pipeline.Execution(
        Processes(1), directory, True, wide_console(), share=share, bits=WorkerBits(mixed=any_bits)
    )
    raise typer.Exit(pipeline.evaluate(evaluation, execution))
