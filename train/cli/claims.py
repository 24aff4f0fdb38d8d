"""`clean-swarm study claims`: strategies on several families at once, corrected for their number."""

from pathlib import Path
from typing import Annotated

import typer

from train.cli.options import wide_console


def claims_command(
    results: Annotated[list[Path], typer.Argument(help="Directories of `evaluate --family`, one for each family.")],
    strategy: Annotated[list[str], typer.Option(help="Label of a strategy in all of them; can be repeated.")],
    against: Annotated[
        str, typer.Option(help="Label of what it is compared with; the best fixed option of each unless given.")
    ] = "",
) -> None:
    """Compare strategies over several families, with intervals and p-values that are corrected for their number."""
    from train.evaluation.choosing.claims import claims_over, claims_table  # imports SciPy and Numba
    from train.reports.text_table import on_terminal

    wide_console().print(on_terminal(claims_table(*claims_over(results, strategy, against))))
