"""Tables of text, shown on a terminal or as Markdown, and the report of which they are: files and printed tables.

A report has a verdict of a few sentences, one table, and further tables: `table.md` has them all, the terminal shows
these with `--all` only.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from selector.documents.writing import write_whole
from train.request import Request
from train.running.run_folder import RunFolder

if TYPE_CHECKING:  # the runs need no Matplotlib
    from pathlib import Path

    from matplotlib.figure import Figure

POINT = "●"
"""The mean in a cell that is drawn; such cells are code in Markdown, whose letters have one width."""
EMPTY_CELL = "-"
"""Text of a cell without a figure."""
LONGEST_LABEL = 40
"""Letters of a label up to which the terminal shows it in one line."""
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
        whole = 0 if k else min(max(map(len, (head, *(row[0] for row in grid.rows)))), LONGEST_LABEL)
        table.add_column(Text(head), justify="right" if k else "left", no_wrap=k > 0, min_width=whole)
    hidden = len(grid.rows) > MAX_ROWS_SHOWN
    for row in () if hidden else grid.rows:
        table.add_row(*row)
    table.add_section()
    for row in grid.summary:
        table.add_row(*row, style="bold")
    more = [f"{len(grid.rows)} {grid.heads[0]}s, one by one in table.md"] if hidden else []
    return Group(table, *more, *grid.notes)


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(f'`{cell}`' if POINT in cell else cell for cell in cells)} |"


@dataclass(frozen=True)
class Publication:
    """Results that an evaluation writes and prints."""

    name: str
    """Title of `table.md`."""
    about: str
    """Text below the title."""
    verdict: Sequence[str]
    """Sentences that say what came out."""
    grids: Sequence[Grid]
    """The table of what is compared, then further ones."""
    summary: Mapping[str, Any]
    """Content of `summary.json`."""
    figure: Figure | None = None
    """What `figure.png` shows."""


def publish(publication: Publication, folder: RunFolder, console: Console, request: Request) -> None:
    """Write the files of a report, and print its tables and the verdict."""
    verdict, (first, *more) = list(publication.verdict), publication.grids
    folder.write("summary.json", json.dumps({"verdict": verdict, **publication.summary}, indent=2) + "\n")
    quoted = "".join(f"> {line}\n" for line in verdict)
    heading = f"# {publication.name}\n\n{quoted}\n{publication.about}\n\n"
    folder.write("table.md", heading + "\n".join(markdown(grid) for grid in publication.grids))
    if publication.figure is not None:
        from train.reports.charts import picture_of

        folder.write("figure.png", picture_of(publication.figure, ".png"))
    for grid in (first, *(more if request.every_table else ())):
        console.print(on_terminal(grid), soft_wrap=True)
        console.print()
    for line in verdict:
        console.print(line, highlight=False)
    hidden = f"; {len(more)} more tables with --all and in table.md" if more and not request.every_table else ""
    console.print(f"results in {folder.path}{hidden}", soft_wrap=True, highlight=False)
    write_figure(publication.figure, request.figure, console)


def write_figure(figure: Figure | None, file: Path | None, console: Console) -> None:
    """Write the figure to the file that `--figure` names, if any."""
    if file is None:
        return
    if figure is None:
        console.print("--figure: these results have no figure", highlight=False)
        return
    from train.reports.charts import picture_of

    write_whole(file, picture_of(figure, file.suffix))
    console.print(f"figure in {file}", soft_wrap=True, highlight=False)
