"""`clean-swarm gather`: merge the results of the shares of an evaluation."""

from pathlib import Path
from typing import Annotated

import typer

from train.cli.options import AnyBits


def gather_command(
    context: typer.Context,
    directory: Annotated[Path, typer.Argument(help="The --output of the shares.", metavar="DIR")],
    any_bits: AnyBits = False,
) -> None:
    """Merge the results of all shares, as if one command had done all runs: runs, tables, figure."""
    from train.evaluation.gathering import gathering_words  # imports Numba

    words = gathering_words(directory) + (["--any-bits"] if any_bits else [])
    raise typer.Exit(context.find_root().command.main(words, "clean-swarm", standalone_mode=False))
