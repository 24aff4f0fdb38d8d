"""Tables of text, shown on a terminal or as Markdown, and the report of which they are: files and printed tables."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich import box
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from train.running.run_folder import RunFolder

EMPTY_CELL = "-"
"""Text of a cell without a figure."""
MAX_ROWS_SHOWN = 30
"""Most rows above the summary that the terminal shows; Markdown always has all rows."""


@dataclass(frozen=True)
class Grid:
    """A table of text whose first column has labels, with `summary` rows below the other rows."""

    title: str
    heads: tuple[str, ...]
    """Heads of all columns; those of a group begin with the line of the group's title."""
    rows: Sequence[Sequence[str]]
    summary: Sequence[Sequence[str]] = ()
    notes: tuple[str, ...] = ()


def interval_cell(ci95: tuple[float, float] | None, digits: int = 3) -> str:
    """Return a 95 % interval; empty if there is none."""
    return "" if ci95 is None else "[{}, {}]".format(*(f"{x:.{digits}f}" if x < 1e5 else f"{x:.1g}" for x in ci95))


def markdown(grid: Grid) -> str:
    """Return a grid as a Markdown table, with all columns but the first aligned to the right."""
    table = markdown_table([head.replace("\n", " ") for head in grid.heads], [*grid.rows, *grid.summary])
    return "\n".join([f"## {grid.title}", "", table, *(f"\n{note}" for note in grid.notes)]) + "\n"


def markdown_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table without a title, with all columns but the first aligned to the right."""
    return "\n".join([_line(heads), f"|---|{'---:|' * (len(heads) - 1)}", *map(_line, rows)])


def on_terminal(grid: Grid) -> RenderableType:
    """Return a grid for a rich console."""
    table = Table(title=grid.title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for k, head in enumerate(grid.heads):
        table.add_column(Text(head), justify="right" if k else "left", no_wrap=k > 0)
    hidden = len(grid.rows) > MAX_ROWS_SHOWN
    for row in () if hidden else grid.rows:
        table.add_row(*row)
    table.add_section()
    for row in grid.summary:
        table.add_row(*row, style="bold")
    more = [f"{len(grid.rows)} {grid.heads[0]}s, one by one in table.md"] if hidden else []
    return Group(table, *more, *grid.notes)


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


@dataclass(frozen=True)
class Publication:
    """Results that an evaluation writes and prints."""

    name: str
    """Title of `table.md`."""
    about: str
    """Text below the title."""
    grids: Sequence[Grid]
    """The tables of `table.md` and of the terminal."""
    summary: Mapping[str, Any]
    """Content of `summary.json`."""
    figure: bytes | None = None
    """Content of `figure.png`."""


def publish(publication: Publication, folder: RunFolder, console: Console) -> None:
    """Write the files of a report, and print its tables."""
    folder.write("summary.json", json.dumps(publication.summary, indent=2) + "\n")
    heading = f"# {publication.name}\n\n{publication.about}\n\n"
    folder.write("table.md", heading + "\n".join(markdown(grid) for grid in publication.grids))
    if publication.figure is not None:
        folder.write("figure.png", publication.figure)
    for grid in publication.grids:
        console.print(on_terminal(grid), soft_wrap=True)
        console.print()
    console.print(f"results in {folder.path}", soft_wrap=True, highlight=False)
