"""Tables of text, shown on a terminal or as Markdown."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

EMPTY_CELL = "-"
"""Text of a cell without a figure."""
MAX_ROWS_SHOWN = 30
"""Most rows above the summary that the terminal shows; Markdown always has all rows."""


@dataclass(frozen=True)
class Columns:
    """A group of columns under one title; a single column has no title."""

    title: str
    heads: tuple[str, ...]


@dataclass(frozen=True)
class Row:
    """A label and, for each group of columns, one cell for each column."""

    label: str
    groups: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Grid:
    """A table of text with `summary` rows below the other rows."""

    title: str
    corner: str
    columns: tuple[Columns, ...]
    rows: tuple[Row, ...]
    summary: tuple[Row, ...] = ()
    notes: tuple[str, ...] = ()


def flat(title: str, corner: str, heads: Sequence[str], rows: Sequence[tuple[str, ...]]) -> Grid:
    """Return a grid without groups; each row starts with its label."""
    columns = tuple(Columns("", (head,)) for head in heads)
    return Grid(title, corner, columns, tuple(Row(label, tuple((cell,) for cell in cells)) for label, *cells in rows))


def interval_cell(ci95: tuple[float, float] | None, digits: int = 3) -> str:
    """Return a 95 % interval; empty if there is none."""
    return "" if ci95 is None else "[{}, {}]".format(*(f"{x:.{digits}f}" if x < 1e5 else f"{x:.1g}" for x in ci95))


def markdown(grid: Grid) -> str:
    """Return a grid as a Markdown table, with all columns but the first aligned to the right."""
    heads = [f"{group.title} {head}".strip() for group in grid.columns for head in group.heads]
    rows = [(row.label, *(cell for group in row.groups for cell in group)) for row in grid.rows + grid.summary]
    table = markdown_table((grid.corner, *heads), rows)
    return "\n".join([f"## {grid.title}", "", table, *(f"\n{note}" for note in grid.notes)]) + "\n"


def markdown_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table without a title, with all columns but the first aligned to the right."""
    return "\n".join([_line(heads), f"|---|{'---:|' * (len(heads) - 1)}", *map(_line, rows)])


def on_terminal(grid: Grid) -> RenderableType:
    """Return a grid for a rich console; the columns of a group share one cell, with the title above them."""
    table = Table(title=grid.title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(grid.corner)
    widths = [_widths(grid, place) for place in range(len(grid.columns))]
    for group, width in zip(grid.columns, widths, strict=True):
        text = Text(f"{group.title}\n" if group.title else "", justify="center")
        table.add_column(text.append(_joined(group.heads, width)), justify="right", no_wrap=True)
    hidden = len(grid.rows) > MAX_ROWS_SHOWN
    for row in () if hidden else grid.rows:
        table.add_row(row.label, *map(_joined, row.groups, widths))
    table.add_section()
    for row in grid.summary:
        table.add_row(row.label, *map(_joined, row.groups, widths), style="bold")
    more = [f"{len(grid.rows)} {grid.corner}s, one by one in table.md"] if hidden else []
    return Group(table, *more, *grid.notes)


def _widths(grid: Grid, place: int) -> list[int]:
    """Return the width of each column of the group at `place`."""
    texts = [grid.columns[place].heads, *(row.groups[place] for row in grid.rows + grid.summary)]
    return [max(map(len, column)) for column in zip(*texts, strict=True)]


def _joined(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(cell.rjust(width) for cell, width in zip(cells, widths, strict=True))


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
