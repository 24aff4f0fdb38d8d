"""`clean-swarm gather`: merge the results of the shares of an evaluation."""

from pathlib import Path
from typing import Annotated

import typer


def gather_command(
    context: typer.Context,
    directory: Annotated[Path, typer.Argument(help="The --output of the shares.", metavar="DIR")],
) -> None:
    """Merge the results of all shares, as if one command had done all runs: runs, tables, figure."""
    from train.evaluation.gathering import gathering_words  # imports Numba

    program = context.find_root().command
    raise typer.Exit(program.main(gathering_words(directory), "clean-swarm", standalone_mode=False))
