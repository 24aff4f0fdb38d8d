"""Reads the pages of the documentation: blocks of code by language, mark and file, lines of commands, and tables."""

import re
import shlex
from typing import Any, NamedTuple

from tests.paths import ROOT

BLOCK = re.compile(
    r"(?:^<!-- ci: (?P<mark>\w+) -->\n)?(?:^`(?P<file>[\w./-]+)`:\n\n)?^```(?P<language>\w*)\n(?P<text>.*?)^```$",
    re.DOTALL | re.MULTILINE,
)


class Block(NamedTuple):
    """A block of code: its page, the line of its first line, its language, `<!-- ci: MARK -->` and `FILE`: above it."""

    page: str
    line: int
    language: str
    mark: str
    file: str
    text: str

    def run(self, names: dict[str, Any] | None = None) -> dict[str, Any]:
        """Run a block of Python with these names, and return them all; errors name the page and its line."""
        names = {} if names is None else names
        exec(compile("\n" * (self.line - 1) + self.text, self.page, "exec"), names)
        return names

    def commands(self) -> list[list[str]]:
        """Return the words of each line of a block of commands, the program first; remarks are left out."""
        lines = re.sub(r" *\\\n *", " ", self.text).splitlines()
        return [words for line in lines if (words := shlex.split(line, comments=True))]


def text_of(page: str) -> str:
    """Return the text of a page by its path from the root of the checkout."""
    return (ROOT / page).read_text(encoding="utf-8")


def blocks(page: str, language: str = "", mark: str = "") -> list[Block]:
    """Return the blocks of code of a page in order: all of them, or those of a language or a mark."""
    text = text_of(page)
    found = [Block(page, text.count("\n", 0, at.start("text")) + 1, *(at[name] or "" for name in Block._fields[2:]))
             for at in BLOCK.finditer(text)]  # fmt: skip
    return [one for one in found if language in ("", one.language) and mark in ("", one.mark)]


def table(page: str, name: str) -> list[list[str]]:
    """Return the cells of each row of the table between `<!-- begin: NAME -->` and `<!-- end: NAME -->`."""
    inside = text_of(page).partition(f"<!-- begin: {name} -->\n")[2].partition(f"<!-- end: {name} -->")[0]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in inside.splitlines()[2:]]
