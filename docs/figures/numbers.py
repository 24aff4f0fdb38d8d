"""Takes the results of README and pages from docs/figures.json: `python -m docs.figures.numbers`, which writes them.

    python -m docs.figures.numbers --check            # says what differs, writes nothing
    python -m docs.figures.numbers --take robustness/crowd [--command "clean-swarm evaluate ..." --inputs FILE...]
    python -m docs.figures.numbers --keep robustness/crowd --because "only a description changed"

`--take` reads a block that somebody filled by hand, after its command has run again; `--command` and `--inputs` are
for a new one. `--keep` says that changed inputs do not change a result. CONTRIBUTING.md says when to use which.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from docs.figures.printed import Found, differing, printed_intervals, result_tables
from docs.figures.stored import (
    ROOT,
    STORE,
    Result,
    Results,
    fingerprint,
    keep,
    load,
    mark_of,
    page_of,
    parts,
    take,
    write_block,
)

COMMAND = "python -m docs.figures.numbers"
EXEMPT = {
    "docs/environment.md: infos": "keys and their meaning; a test compares it with the code",
    "docs/environment.md: rewards": "weights and their defaults; a test compares it with the code",
    "docs/robots.md: | mission | true radius | true speed, turn rate | `--scale` |": "settings",
    "docs/tasks.md: tasks": "names, options and targets; a test compares it with the code",
}
"""Page and mark, or page and head of the table -> why its numbers are no results."""


def write(root: Path = ROOT) -> None:
    """Write all blocks into their pages."""
    for result_id, result in load(root).items():
        if not result.prose:
            write_block(result_id, result, root)


def pages(root: Path = ROOT) -> list[Path]:
    """Return README, all pages and the cards of policies; records of decisions tell of their time and are left out."""
    folders = root / "docs", root / "docs" / "tutorials", *sorted((root / "configs" / "policies").glob("*"))
    return [root / "README.md", *(page for folder in folders for page in sorted(folder.glob("*.md")))]


def faults(root: Path = ROOT) -> list[str]:
    """Return what is wrong, a line each: pages that differ, stale inputs, and results that are not in the store."""
    results = load(root)
    figures = ((result_id, figure) for result_id, result in results.items() for figure in result.figures)
    if odd := [f"{STORE}: {result_id}: {line}" for result_id, figure in figures for line in figure.faults()]:
        return odd
    found = list[str]()
    for result_id, result in results.items():
        where = f"{page_of(result_id)}: {result_id}"
        wrong = (*_on_the_page(result_id, result, root), *_of_others(result, results), *_inputs(result, root))
        found += [f"{where}: {line}" for line in wrong]
    for page in pages(root):
        found += _not_stored(page, results, root)
    return found


def _on_the_page(result_id: str, result: Result, root: Path) -> Iterator[str]:
    """Yield where a page differs from the store."""
    text = (root / page_of(result_id)).read_text(encoding="utf-8")
    if not result.figures and "{}" in "".join(result.layout):
        yield f"expected figures, got none yet; `{COMMAND} --take {result_id}` takes the page's"
        return
    if result.prose:
        words = " ".join(text.split())
        for sentence in result.text.splitlines():
            if " ".join(sentence.split()) not in words:
                yield f"expected in the prose, as in {STORE}: {sentence}"
        return
    try:
        block = parts(text, mark_of(result_id))[1]
    except ValueError as error:
        yield str(error)
        return
    for line in differing(block, result.text):
        yield f"{line}, as in {STORE}; `{COMMAND}` writes it, `{COMMAND} --take {result_id}` takes the page's"


def _of_others(result: Result, results: Results) -> Iterator[str]:
    """Yield the figures that are not in the results from which they are said to be."""
    if not result.of:
        return
    if unknown := [other for other in result.of if other not in results]:
        yield f"of: expected ids of results, got {', '.join(unknown)}"
        return
    known = [figure for other in result.of for figure in results[other].figures]
    for figure in result.figures:
        if not any(figure.tells(one) for one in known):
            yield f"expected figures of {', '.join(result.of)}, got {figure.printed()} ({figure.row})"


def _inputs(result: Result, root: Path) -> Iterator[str]:
    """Yield that inputs changed."""
    try:
        found = fingerprint(result.inputs, root)
    except ValueError as error:
        yield str(error)
        return
    if found != result.fingerprint:
        files = ", ".join(result.inputs)
        yield f"inputs changed ({files}, or files that they name); make it again: {result.command}"


def _not_stored(page: Path, results: Results, root: Path) -> Iterator[str]:
    """Yield the tables of results on a page that are in no block of the store, and intervals in prose likewise."""
    name, text = page.relative_to(root).as_posix(), page.read_text(encoding="utf-8")
    blocks = {mark_of(result_id) for result_id in results if page_of(result_id) == name}
    if "" in blocks:
        return
    for table in result_tables(text):
        if table.mark not in blocks and not exempt(name, table):
            yield f"{name}, line {table.line}: expected a block of {STORE}, got a table of results: {table.head}"
    figures = [figure for result in results.values() for figure in result.figures if figure.interval]
    for line, figure in printed_intervals(text):
        if not any(figure.tells(one) for one in figures):
            yield f"{name}, line {line}: expected an interval of {STORE}, got {figure.printed()}"


def exempt(page: str, table: Found) -> bool:
    """Whether a table that looks like results has none."""
    return f"{page}: {table.mark or table.head}" in EXEMPT


def main(arguments: Sequence[str]) -> int:
    """Write all blocks, or do what the arguments say; return 1 if something is wrong afterwards."""
    parser = argparse.ArgumentParser(prog=COMMAND, description="The results of README and pages.")
    parser.add_argument("--check", action="store_true", help="say what differs, write nothing")
    parser.add_argument("--take", metavar="ID", help="record what the page says")
    parser.add_argument("--command", default="", help="with --take: what makes the result")
    parser.add_argument("--inputs", nargs="+", default=(), metavar="FILE", help="with --take: what decides the result")
    parser.add_argument("--keep", metavar="ID", help="changed inputs do not change the result")
    parser.add_argument("--because", metavar="TEXT", help="with --keep: why")
    given = parser.parse_args(arguments)
    if given.keep and not given.because:
        parser.error("--keep: expected --because TEXT as well")
    if given.take:
        take(given.take, given.command, given.inputs)
    elif given.keep:
        keep(given.keep, given.because)
    elif not given.check:
        write()
    wrong = faults()
    print(*wrong, sep="\n", end="\n" if wrong else "", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
