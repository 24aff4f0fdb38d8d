"""What the tables of the pages say about a name: the rows that begin with it, so that no number is copied by hand."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from docs.site.stage import ROOT

PAGES = ("results", "choosing", "families", "transport", "learning", "models", "walls", "strategies", "environment")
"""Pages of docs/ whose tables are read, in the order in which their rows are shown."""


@dataclass(frozen=True)
class Found:
    """Rows of one table that are about a name.

    Attributes:
        page: the page that has the table.
        heading: the heading above it.
        head: the first two lines of the table.
        rows: the rows.

    """

    page: Path
    heading: str
    head: str
    rows: tuple[str, ...]


@cache
def tables() -> tuple[Found, ...]:
    """Return all tables of the pages."""
    return tuple(table for name in PAGES for table in _tables_of(ROOT / "docs" / f"{name}.md"))


def _tables_of(page: Path) -> Iterator[Found]:
    text = re.sub(r"(?ms)^ *```.*?^ *```$", "", page.read_text(encoding="utf-8"))
    for mark, address in re.findall(r"(?m)^\[([\w-]+)\]: (\S+)$", text):
        text = text.replace(f"][{mark}]", f"]({address})")
    heading, table = "", list[str]()
    for line in [*text.splitlines(), ""]:
        if line.startswith("|"):
            table.append(line)
            continue
        if len(table) > 2:
            yield Found(page, heading, "\n".join(table[:2]), tuple(table[2:]))
        table = []
        if line.startswith("#"):
            heading = line.lstrip("# ").strip()


def rows_about(name: str) -> list[Found]:
    """Return the rows of all tables whose first cell begins with a name, with those below that go on under it.

    Tables of stories are left out: the page of a name has its story already.
    """
    found = []
    for table in tables():
        if "| story |" in table.head:
            continue
        rows, ours = [], False
        for row in table.rows:
            first = row.split("|")[1].strip()
            ours = named(first) == name if first else ours
            if ours:
                rows.append(row)
        if rows:
            found.append(Found(table.page, table.heading, table.head, tuple(rows)))
    return found


def named(cell: str) -> str:
    """Return the name with which a cell begins."""
    return re.split(r"[,;] ", cell)[0].strip("`* ")


def anchor(heading: str) -> str:
    """Return the anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
