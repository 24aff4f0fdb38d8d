"""Tables on terminals: a narrow one gets fewer columns, but every name and every number whole."""

import io
import re

import numpy as np
import pytest
from rich.console import Console

from tests.train.commands import done
from train.analysis.verdict import Ranking
from train.reports.ranking_table import ranking_table
from train.reports.text_table import Grid, TerminalTable, markdown_table

NAMES = ("models:fly=fixed:ORCA+Patrol;mule=fixed:ORCA+RecentFinds", "fixed:ORCA", "a" * 70)
HEADS = ("strategy", "cost s [95 %]", "0 to 563", "times the first [95 %]", "unfinished", "duration s", "events")
CELLS = ("183 [95, 271]", "···├──●──┤··········", "2.56 [1.43, 4.59]", "0%", "1,266", "0.915")


def printed(grid, width, *, terminal=True):
    console = Console(width=width, file=io.StringIO(), force_terminal=terminal, color_system=None, highlight=False)
    console.print(TerminalTable(grid))
    return console.file.getvalue()


def column(text, place=0):
    """The letters of the first column, without its breaks."""
    return "".join(line.split("   ")[place].strip() for line in text.splitlines())


@pytest.mark.parametrize("width", [60, 80, 100, 140, 300])
def test_no_name_is_cut_and_no_line_is_wider_than_the_terminal(width):
    text = printed(Grid("title", HEADS, [(name, *CELLS) for name in NAMES], notes=("a note",)), width)
    assert "…" not in text
    assert all(len(line.rstrip()) <= width for line in text.splitlines())
    assert all(name in column(text) for name in NAMES)
    assert text.count("183 [95, 271]") == len(NAMES)
    told = re.search(r"a wider terminal and table.md also show: (.*) a note", " ".join(text.split()))
    left_out = told[1].split(", ") if told else []
    assert set(left_out) <= set(HEADS)
    for head, cell in zip(HEADS[1:], CELLS, strict=True):
        assert (text.count(cell) >= len(NAMES)) == (head not in left_out) or "●" in cell, head
    assert (CELLS[1] in text) == (width == 300)


def test_the_papers_figures_fit_into_80_columns_and_a_title_says_which_starts(tmp_path):
    words = ("evaluate", "--workers", 1, "--output")
    given, drawn = done(*words, tmp_path / "own"), done(*words, tmp_path / "drawn", "--scenarios", 2)
    assert given.startswith("table1: 5 scenarios, seed 0, given starts")
    assert drawn.startswith("table1: 2 scenarios, seed 0, random starts")
    assert given.splitlines()[2].split()[-4:] == ["[95", "%]", "p", "(Holm)"]
    heads, *_, first, second = markdown_of(tmp_path / "own")[:4]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in (heads, first, second)]
    text = " ".join(printed(Grid("t", tuple(cells[0]), cells[1:]), 80).split())
    assert "266.4 0.915 2.16" in text
    assert "also show: unfinished (at most), times the first [95 %], p (Holm)" in text


def markdown_of(folder):
    """The lines of the first table of results."""
    return [line for line in (folder / "table.md").read_text().splitlines() if line.startswith("|")]


def test_a_file_gets_every_column():
    text = printed(Grid("title", HEADS, [(name, *CELLS) for name in NAMES]), 10_000, terminal=False)
    assert all(any(line.split() and line.split()[0] == name for line in text.splitlines()) for name in NAMES)
    assert all(head in text for head in HEADS)
    assert "wider" not in text


def test_heads_of_groups_fold_and_intervals_do_not():
    heads = ("scenario", *(f"{name}\n{head}" for name in ("Fernandez", "Gradient") for head in ("time s", "coll/s")))
    grid = Grid("t", heads, [("1", *["1,526.80 [1,000, 20,000]"] * 4)], [("mean", *["4.0"] * 4)])
    text = printed(grid, 60)
    assert text.count("[1,000, 20,000]") == 2
    assert "also show: Gradient time s, Gradient coll/s" in " ".join(text.split())


def test_of_many_rows_the_first_and_those_that_were_named_are_shown():
    names = [f"fixed:{number}" for number in range(35)]
    text = printed(Grid("t", HEADS, [(name, *CELLS) for name in (*names, "MaxScore", "Random")]), 200)
    shown = [line.split()[0] for line in text.splitlines() if CELLS[0] in line]
    assert shown == [*names[:10], "MaxScore", "Random"]
    assert "12 of 37 rows; all are in table.md" in text


def test_a_label_is_one_cell_of_one_line():
    assert markdown_table(("a", "b"), [("one\ntwo|three", "1")]).splitlines()[2:] == [r"| one two\|three | 1 |"]


def test_ratios_have_digits_that_say_something_and_depend_on_the_other_rows():
    """A ratio is said as its interval is; another row makes all intervals wider, and a line below says so."""
    few = np.linspace(0.9, 1.1, 12)
    table = ranking_table("t", Ranking.of({"a": few, "b": 1116.15 * few, "c": 263.1 * few[::-1]}), "cost s", {})
    again = {row[0]: row[3] for row in table.rows}
    assert again["b"] == "over 1,000 [over 1,000, over 1,000]"
    assert re.fullmatch(r"263 \[\d+, \d+\]", again["c"])
    two = Ranking.of({"a": few, "c": 263.1 * few[::-1]})
    three = Ranking.of({"a": few, "c": 263.1 * few[::-1], "d": 9.0 * few})
    assert three.interval("c", "a")[0] < two.interval("c", "a")[0]
    assert any("another row makes all of them wider" in note for note in table.notes)


def test_no_sentence_is_written_twice(tmp_path):
    done("evaluate", "table1", "--scenarios", 1, "--workers", 1, "--output", tmp_path / "run")
    lines = (tmp_path / "run" / "table.md").read_text().splitlines()
    sentences = [line for line in lines if line and not line.startswith("|")]
    assert sorted(set(sentences)) == sorted(sentences)
