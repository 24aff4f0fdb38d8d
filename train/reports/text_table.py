"""Tables of text, shown on a terminal or as Markdown, and the report of which they are: files and printed tables.

A report has a verdict of a few sentences, one table, and further tables: `table.md` has them all, the terminal shows
these with `--all` only.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from train.request import Request
from train.running.run_folder import RunFolder

if TYPE_CHECKING:  # the runs need no Matplotlib
    from matplotlib.figure import Figure

POINT = "●"
"""The mean in a cell that is drawn; such cells are code in Markdown, whose letters have one width."""
EMPTY_CELL = "-"
"""Text of a cell without a figure."""
LEAST_LABEL, LEAST_HEAD = 16, 10
"""Letters in a line of a name, and of a head, that a narrow terminal shows at least."""
BREAKS = re.compile(r"(?:(?<=[\s+;:=,/-])|(?<=[a-z0-9])(?=[A-Z]))(?![^\[]*\])")
"""Places at which names, heads and cells may be broken; intervals are not."""
MAX_ROWS_SHOWN, FIRST_ROWS, EACH = 30, 10, "fixed:"
"""Most rows that a terminal shows all; where there are more, and no summary, it shows the first and those that one has
named, whose labels do not begin with that of each option. Markdown has all rows."""


@dataclass(frozen=True)
class Grid:
    """A table of text whose first column has labels, with `summary` rows below the other rows."""

    title: str
    heads: tuple[str, ...]
    """Heads of all columns; those of a group begin with the line of the group's title."""
    rows: Sequence[Sequence[str]]
    summary: Sequence[Sequence[str]] = ()
    notes: tuple[str, ...] = ()


def markdown(grid: Grid) -> str:
    """Return a grid as a Markdown table, with all columns but the first aligned to the right."""
    table = markdown_table([head.replace("\n", " ") for head in grid.heads], [*grid.rows, *grid.summary])
    return "\n".join([f"## {grid.title}", "", table, *(f"\n{note}" for note in grid.notes)]) + "\n"


def markdown_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table without a title, with all columns but the first aligned to the right."""
    return "\n".join([_line(heads), f"|---|{'---:|' * (len(heads) - 1)}", *map(_line, rows)])


@dataclass(frozen=True)
class TerminalTable:
    """A grid as a rich console prints it: with its whole width, but on a terminal no wider than that.

    A narrow terminal gets, in this order: heads of several lines, no drawn column, cells of several lines, and no last
    columns. No name and no number is cut, and a line says which columns are left out.
    """

    grid: Grid

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the table that fits, and the lines below it."""
        grid, room = _shortened(self.grid), options.max_width if console.is_terminal else sys.maxsize
        unbounded = options.update(max_width=sys.maxsize)
        for columns, label, folds in _narrower(grid, room):
            table = _table(grid, columns, label, folds=folds)
            if Measurement.get(console, unbounded, table).maximum <= room:
                break
        yield from console.render(table, unbounded)
        if len(grid.rows) < len(self.grid.rows):
            yield f"{len(grid.rows) or 'none'} of {len(self.grid.rows)} rows; all are in table.md"
        drawn = {k for row in grid.rows for k, cell in enumerate(row) if POINT in cell}
        left_out = [" ".join(head.split()) for k, head in enumerate(grid.heads) if k not in {*columns, *drawn}]
        if left_out:
            yield Text(f"a wider terminal and table.md also show: {', '.join(left_out)}", style="dim")
        yield from grid.notes


def _shortened(grid: Grid) -> Grid:
    """Return a grid with the rows that a terminal shows."""
    if len(grid.rows) <= MAX_ROWS_SHOWN:
        return grid
    named = [row for row in grid.rows[FIRST_ROWS:] if not row[0].startswith(EACH)]
    return replace(grid, rows=() if grid.summary else (*grid.rows[:FIRST_ROWS], *named))


def _narrower(grid: Grid, room: int) -> Iterator[tuple[list[int], int, bool]]:
    """Yield what makes a table narrower, step by step: columns, letters in a line of a cell, whether heads fold."""
    rows, every, narrow = (*grid.rows, *grid.summary), list(range(len(grid.heads))), max(room // 3, LEAST_LABEL)
    plain = [k for k in every if not any(POINT in row[k] for row in rows)]
    yield from ((every, room, False), (every, room, True), (plain, room, True), (plain, narrow, True))
    yield from ((plain[:count], narrow, True) for count in range(len(plain) - 1, 1, -1))


def _table(grid: Grid, columns: Sequence[int], label: int, *, folds: bool) -> Table:
    """Return some columns of a grid, with lines of `label` letters at most in a cell; heads may fold to their cells."""
    table = Table(title=grid.title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for k in columns:
        cells = max((min(len(row[k]), label) for row in (*grid.rows, *grid.summary)), default=0)
        head = _folded(grid.heads[k], max(cells, LEAST_HEAD)) if folds and k else grid.heads[k]
        table.add_column(Text(head), justify="right" if k else "left", no_wrap=True)
    for row in grid.rows:
        table.add_row(*(Text(_folded(row[k], label)) for k in columns))
    table.add_section()
    for row in grid.summary:
        table.add_row(*(Text(row[k]) for k in columns), style="bold")
    return table


def _folded(text: str, width: int) -> str:
    r"""Return a text in lines of at most `width` letters, broken between words and parts of names if that is possible.

    >>> _folded("models:fly=fixed:ORCA+Patrol;mule=fixed:Off", 22)
    'models:fly=fixed:ORCA+\nPatrol;mule=fixed:Off'

    """
    lines = []
    for line in text.split("\n"):
        lines.append("")
        for part in re.split(BREAKS, line):
            letters = max(len(part), 1) if "[" in part else width
            for piece in (part[k : k + letters] for k in range(0, len(part), letters)):
                if lines[-1] and len(lines[-1] + piece.rstrip()) > width:
                    lines.append("")
                lines[-1] += piece
    return "\n".join(map(str.rstrip, lines))


def _line(cells: Sequence[str]) -> str:
    whole = [" ".join(cell.splitlines()).replace("|", r"\|") for cell in cells]
    return f"| {' | '.join(f'`{cell}`' if POINT in cell else cell for cell in whole)} |"


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
    """What `figure.png` and `figure.svg` show."""


def publish(publication: Publication, folder: RunFolder, console: Console, request: Request) -> None:
    """Write the files of a report, and print its tables and the verdict."""
    verdict, (first, *more) = list(publication.verdict), publication.grids
    folder.write("summary.json", json.dumps({"verdict": verdict, **publication.summary}, indent=2) + "\n")
    quoted = "".join(f"> {line}\n" for line in verdict)
    heading = f"# {publication.name}\n\n{quoted}\n{publication.about}\n\n"
    folder.write("table.md", heading + "\n".join(markdown(grid) for grid in publication.grids))
    if publication.figure is not None:
        from train.reports.charts import picture_of

        for suffix in (".png", ".svg"):
            folder.write(f"figure{suffix}", picture_of(publication.figure, suffix))
    for grid in (first, *(more if request.every_table else ())):
        console.print(TerminalTable(grid))
        console.print()
    for line in verdict:
        console.print(line, highlight=False)
    hidden = f"; {len(more)} more tables with --all and in table.md" if more and not request.every_table else ""
    console.print(f"results in {folder.path}{hidden}", soft_wrap=True, highlight=False)
