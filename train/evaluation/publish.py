"""What an evaluation writes and prints: `table.md`, `summary.json`, `figure.png`, and the tables on the terminal."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Console

from train.reports.text_table import Grid, markdown, on_terminal
from train.running.run_folder import RunFolder


@dataclass(frozen=True)
class Publication:
    """Results that an evaluation writes and prints."""

    heading: str
    """First lines of `table.md`."""
    grids: Sequence[Grid]
    """The tables of `table.md` and of the terminal."""
    summary: str
    """Content of `summary.json`."""
    figure: bytes | None = None
    """Content of `figure.png`."""


def publish(publication: Publication, folder: RunFolder, console: Console) -> None:
    """Write the files of a report, and print its tables."""
    folder.write("summary.json", publication.summary)
    folder.write("table.md", publication.heading + "\n".join(markdown(grid) for grid in publication.grids))
    if publication.figure is not None:
        folder.write("figure.png", publication.figure)
    for grid in publication.grids:
        console.print(on_terminal(grid), soft_wrap=True)
        console.print()
    console.print(f"results in {folder.path}", soft_wrap=True, highlight=False)
