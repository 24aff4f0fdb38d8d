"""Reads figures out of the Markdown in which they are printed, and prints them there again, digit by digit."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import groupby
from typing import Any

NUMBER = r"(?<![\w.\-])-?(?:\d{1,3}(?:,\d{3})+|\d+)(?:\.\d+)?(?!\.?\w)"
INTERVAL = rf"({NUMBER})((?:\s?%)?\**\s+)\[({NUMBER}),\s+({NUMBER})\]"
APART = r"`[^`]*`|\]\([^)]*\)|\[1/\w+\]"
"""Code, addresses of links, and units: their digits are no figures."""
IN_TABLES = re.compile(rf"{APART}|{INTERVAL}|{NUMBER}")
IN_WORDS = re.compile(rf"{APART}|{INTERVAL}|{NUMBER}(?=\s*%)|(?<![\w.\-])-?\d+\.\d+(?!\.?\w)")
"""In lines that are no rows of a table, whole numbers are counts, scenarios, seeds and years."""
BRACKETS = r"\[(1/\w+|[^\d\]]+)\]"
UNIT = r"(%|s an item|ms|us|s|min|MB|kB|m2|m/s|m|ev\.)(?!\w)"
MANY = 0.4
"""Share of numbers among the cells above which a table has results."""


@dataclass(frozen=True)
class Figure:
    """One number of a result, with its digits as printed.

    Attributes:
        row: the row of the table, or the words before it.
        column: the head above it; empty in prose.
        value: the number.
        unit: its unit; empty for ratios and counts.
        interval: lower and upper end, if there is one.

    """

    row: str
    column: str
    value: Decimal
    unit: str = ""
    interval: tuple[Decimal, Decimal] | None = None

    @classmethod
    def of(cls, members: Mapping[str, Any]) -> "Figure":
        """Return the figure of a line of JSON."""
        return cls(**{**members, "interval": tuple(members["interval"]) if members["interval"] else None})

    def line(self) -> str:
        """Return the figure as a line of JSON."""
        interval = "null" if self.interval is None else f"[{self.interval[0]}, {self.interval[1]}]"
        row, column, unit = (json.dumps(word, ensure_ascii=False) for word in (self.row, self.column, self.unit))
        return f'{{"row": {row}, "column": {column}, "value": {self.value}, "unit": {unit}, "interval": {interval}}}'

    def printed(self) -> str:
        """Return value and interval as a page has them."""
        unit = " %" if self.unit == "%" else ""
        return f"{self.value}{unit}" + (f" [{self.interval[0]}, {self.interval[1]}]" if self.interval else "")

    def numbers(self) -> tuple[Decimal, ...]:
        """Return the value and the ends of the interval."""
        return (self.value, *(self.interval or ()))

    def faults(self) -> Iterator[str]:
        """Yield what is wrong with the figure itself."""
        if not all(number.is_finite() for number in self.numbers()):
            yield f"expected finite numbers, got {self.line()}"
        elif self.interval is not None and not self.interval[0] <= self.value <= self.interval[1]:
            yield f"expected the value within its interval, got {self.line()}"

    def tells(self, exact: "Figure") -> bool:
        """Whether this is a figure, rounded; or what a ratio saves: 16 % [12, 19] is of 0.845 [0.811, 0.880]."""
        ours, theirs = self.numbers(), exact.numbers()
        if self.interval is not None and exact.interval is None:
            return False
        same = all(_rounded(one, other) for one, other in zip(ours, theirs, strict=False))
        if same or self.unit != "%":
            return same
        saved = [100 - 100 * number for number in (theirs[0], *theirs[:0:-1])]
        return all(_rounded(one, other) for one, other in zip(ours, saved, strict=False))


def _rounded(printed: Decimal, exact: Decimal) -> bool:
    """Whether a number is another one with as many digits or fewer."""
    return abs(printed - exact) * 2 <= Decimal(1).scaleb(int(printed.as_tuple().exponent))


def shown(layout: Sequence[str], figures: Sequence[Figure]) -> str:
    """Return the lines of a layout with the numbers of figures at their places."""
    return "\n".join(layout).format(*(number for figure in figures for number in figure.numbers()))


def differing(got: str, expected: str) -> Iterator[str]:
    """Yield the first line in which a block of a page differs, none if it does not."""
    if got == expected:
        return
    ours, theirs = got.splitlines(), expected.splitlines()
    for one, other in zip(ours, theirs, strict=False):
        if one != other:
            yield f"expected '{other}', got '{one}'"
            return
    yield f"expected {len(theirs)} lines, got {len(ours)}"


def parsed(block: str, *, every: bool = False) -> tuple[tuple[str, ...], tuple[Figure, ...]]:
    """Return the layout of a block, with `{}` for each number, and its figures; `every`: whole numbers in words too."""
    layout, figures = list[str](), list[Figure]()
    for in_table, group in groupby(block.splitlines(), key=lambda line: line.startswith("|")):
        lines = list(group)
        if in_table:
            layout += _read_table(lines, figures)
        else:
            layout += [_read(line, IN_TABLES if every else IN_WORDS, None, figures) for line in lines]
    return tuple(layout), tuple(figures)


def _read_table(lines: Sequence[str], figures: list[Figure]) -> Iterator[str]:
    """Yield the layout of the lines of a table, and append its figures."""
    heads, rows = cells_of(lines[0]), [cells_of(line) for line in lines[2:]]
    yield from (_escaped(line) for line in lines[:2])
    first = 1 if len(rows) > 1 else 0
    for row, name in zip(rows, _row_names(rows), strict=True):
        unit = next((found[1] for cell in row if (found := re.search(BRACKETS, cell))), "")
        cells = [_escaped(cell) for cell in row[:first]]
        for cell, head in zip(row[first:], heads[first:], strict=True):
            cells.append(_read(cell, IN_TABLES, (name, _words(head), _unit_of(head) or unit), figures))
        yield f"|{'|'.join(cells)}|"


def _read(text: str, pattern: re.Pattern[str], place: tuple[str, str, str] | None, figures: list[Figure]) -> str:
    """Return a text with `{}` for each number, and append its figures; `place` is row, column and unit of a cell."""

    def noted(found: re.Match[str]) -> str:
        if found[0][0] in "`[]":
            return found[0]
        value = found[1] or found[0]
        row, column, unit = place or (" ".join(_words(_plain(found.string[: found.start()])).split()[-8:]), "", "")
        after = re.match(rf"\**\s*{UNIT}", found.string[found.end(1) if found[1] else found.end() :])
        interval = (_number(found[3]), _number(found[4])) if found[1] else None
        figures.append(Figure(row, column, _number(value), after[1].strip() if after else unit, interval))
        ends = f"{found[2]}[{_place(found[3])}, {_place(found[4])}]" if found[1] else ""
        return _place(value) + ends

    return pattern.sub(noted, _escaped(text))


def _number(text: str) -> Decimal:
    return Decimal(text.replace(",", ""))


def _place(number: str) -> str:
    """Return the place of a number in a layout."""
    return "{:,}" if "," in number else "{}"


def _escaped(text: str) -> str:
    return text.replace("{", "{{").replace("}", "}}")


def _plain(text: str) -> str:
    return text.replace("{{", "{").replace("}}", "}")


def cells_of(line: str) -> list[str]:
    """Return the cells of a row of a table, with their blanks."""
    return re.split(r"(?<!\\)\|", line.strip())[1:-1]


def _words(text: str) -> str:
    """Return a text without marks of Markdown."""
    return " ".join(re.sub(r"[`*|]", "", text).split())


def _unit_of(head: str) -> str:
    """Return the unit that the head of a column names: in brackets, or as its last word."""
    found = re.search(BRACKETS, head) or re.search(rf"(?<=[a-z] ){UNIT}$", head.strip())
    return found[1] if found else ""


def _row_names(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a name for each row: its first cell, that above if it is empty, and further cells while names repeat."""
    names = list[str]()
    for row in rows:
        names.append(_words(row[0]) or (names[-1] if names else ""))
    for further in range(1, len(rows[0]) if rows else 1):
        if len(set(names)) == len(names):
            break
        cells = [_words(row[further]) for row in rows]
        names = [f"{name}, {cell}" if cell else name for name, cell in zip(names, cells, strict=True)]
    return names


@dataclass(frozen=True)
class Found:
    """A table of a page that has results.

    Attributes:
        line: the line of its head.
        head: its head.
        mark: the block in which it is; empty outside of all.

    """

    line: int
    head: str
    mark: str


def result_tables(text: str) -> Iterator[Found]:
    """Yield the tables that look like results: in a block, with an interval, or with numbers in many of their cells."""
    mark, lines = "", without_code(text).splitlines()
    for in_table, group in groupby(enumerate(lines, 1), key=lambda numbered: numbered[1].startswith("|")):
        numbered = list(group)
        if in_table:
            rows = [cells_of(line) for _, line in numbered[2:]]
            number, head = numbered[0]
            if mark or has_results(rows):
                yield Found(number, head, mark)
        else:
            for _, line in numbered:
                if found := re.fullmatch(r"<!-- (begin|end): (.*) -->", line):
                    mark = found[2] if found[1] == "begin" else ""


def has_results(rows: Sequence[Sequence[str]]) -> bool:
    """Whether rows of cells are results."""
    cells = [cell.strip(" *~<>=≤≥") for row in rows for cell in (row[1:] if len(rows) > 1 else row)]
    if any(re.search(INTERVAL, cell) for cell in cells):
        return True
    return sum(bool(re.match(NUMBER, cell)) for cell in cells) > MANY * len(cells)


def printed_intervals(text: str) -> Iterator[tuple[int, Figure]]:
    """Yield the lines and figures of the intervals in the prose of a page: `16 % [12, 19]`; tables have blocks."""
    prose = re.sub(r"(?m)^\|.*$", "", re.sub(r"`[^`\n]*`", "", without_code(text)))
    for found in re.finditer(INTERVAL, prose):
        interval = (_number(found[3]), _number(found[4]))
        figure = Figure("", "", _number(found[1]), "%" if "%" in found[2] else "", interval)
        yield prose.count("\n", 0, found.start()) + 1, figure


def without_code(text: str) -> str:
    """Return a page with empty lines in place of its blocks of code."""
    return re.sub(r"(?ms)^ *```.*?^ *```$", lambda found: "\n" * found[0].count("\n"), text)
