"""docs/figures.json has every result of README and pages, and what differs from it or is out of date is found."""

import re
import shutil
from decimal import Decimal

import pytest

from docs.figures import numbers
from docs.figures.printed import Figure, parsed, result_tables
from docs.figures.stored import ROOT, STORE, input_files, keep, load, record, save, take


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A copy of all pages and inputs, at a commit of its own."""
    inputs = [path for result in load().values() for path in input_files(result.inputs, ROOT)]
    for path in {*numbers.pages(), ROOT / STORE, *inputs}:
        own = tmp_path / path.relative_to(ROOT)
        own.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, own)
    monkeypatch.setattr("docs.figures.stored.head_commit", lambda root: "0123456789ab")
    return tmp_path


def changed(path, old, new):
    text = path.read_text(encoding="utf-8")
    assert old in text, f"{path.name}: {old}"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


AGAIN = "docs/choosing.md: choosing/main: .*inputs changed.*make it again: python -m docs.comparison.write_choosing$"
ODD = '"value": 0.795, "unit": "", "interval": [0.757, 0.834]'


def test_every_result_on_a_page_is_a_figure_that_is_up_to_date():
    assert numbers.faults() == []


def test_the_store_says_of_each_result_what_makes_it():
    results = load()
    assert sum(len(result.figures) for result in results.values()) > 500
    for result_id, result in results.items():
        assert result.figures, result_id
        assert bool(result.command) != bool(result.of), result_id
        assert bool(result.command) == bool(re.fullmatch("[0-9a-f]{12}", result.commit)), result_id
        assert bool(result.inputs) == bool(result.fingerprint), result_id


def test_figures_are_those_that_are_read_from_their_printed_text():
    for result_id, result in load().items():
        assert parsed(result.text, every=result.prose) == (result.layout, result.figures), result_id


def test_storing_changes_nothing(copy):
    before = (copy / STORE).read_bytes()
    save(load(copy), copy)
    numbers.write(copy)
    assert (copy / STORE).read_bytes() == before
    assert numbers.faults(copy) == []


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        # a digit of a page
        ("docs/choosing.md", "**0.603** [0.506, 0.717] | **0.571**", "**0.602** [0.506, 0.717] | **0.571**", "main"),
        ("docs/results.md", "6.36 [5.92, 6.8]", "6.36 [5.93, 6.8]", "tasks"),
        ("docs/results.md", "468 [374, 563]", "469 [374, 563]", "table1"),
        ("docs/benchmarks.md", "| tick / floor, 1 x 5 | ", "| tick / floor, 1 x 5 | 9", "measured"),  # whatever it is
        ("docs/tutorials/learn.md", "| 49.9 s | 8.8 |", "| 49.9 s | 8.7 |", "drivers"),
        ("docs/models.md", "0.96 [0.88, 1.04]", "0.96 [0.88, 1.05]", "options"),
        ("docs/tutorials/selector.md", "19 % [12, 25]", "19 % [13, 25]", "saved"),
        ("README.md", "20 % [17, 24]", "20 % [17, 23]", "choosing"),
        ("README.md", "costs 1.17 [1.07, 1.27]", "costs 1.17 [1.07, 1.28]", "crowd"),
        # inputs of a result
        ("configs/families/clustered.yaml", "[6, 12]", "[6, 11]", AGAIN),
        ("configs/missions/exploring.yaml", "stop: 2.0", "stop: 3.0", AGAIN),
        ("configs/mechanisms/ORCA.yaml", "horizon: 2.0", "horizon: 2.1", AGAIN),
        # the store
        (STORE, ODD, ODD.replace("0.795", "0.895"), rf"{STORE}: choosing/.*within its interval"),
        (STORE, ODD, ODD.replace("0.795", "NaN"), rf"{STORE}: choosing/.*finite"),
        (STORE, ODD, ODD.replace("0.834", "Infinity"), rf"{STORE}: choosing/.*finite"),
        # marks
        (
            "docs/network.md",
            "<!-- begin: speed -->\n",
            "",
            "docs/network.md: network/speed: expected the marks <!-- begin: speed --> and <!-- end: speed -->",
        ),
    ],
)
def test_what_differs_is_found(copy, file, old, new, said):
    changed(copy / file, old, new)
    line = said if ":" in said else rf"{file}: (\S+/)?{said}: expected "
    assert any(re.match(line, found) for found in numbers.faults(copy))


def test_a_digit_of_the_store_is_found_too_and_written_into_the_page(copy):
    old = '{"row": "clustered", "column": "told / best", "value": 0.763'
    changed(copy / STORE, old, old.replace("0.763", "0.764"))
    (line,) = numbers.faults(copy)
    assert line.startswith("docs/choosing.md: choosing/told: expected '| `clustered` | **0.764**")
    assert numbers.COMMAND in line
    numbers.write(copy)
    assert numbers.faults(copy) == []
    assert "| `clustered` | **0.764**" in (copy / "docs" / "choosing.md").read_text(encoding="utf-8")


def test_a_quotation_of_a_figure_that_changed_is_found(copy):
    changed(
        copy / "docs" / "learning.md",
        "| `fixed:ORCA` | 0 % | 48.8 | 5.0 | 58.8",
        "| `fixed:ORCA` | 0 % | 48.8 | 5.0 | 61.8",
    )
    take("learning/library", root=copy)
    found = [line for line in numbers.faults(copy) if line.startswith("docs/results.md: results/crowd: ")]
    assert found == ["docs/results.md: results/crowd: expected figures of learning/library, got 59 (which costs)"]


def test_a_result_that_is_recorded_again_or_kept_for_a_reason_is_up_to_date(copy):
    path = copy / "configs" / "experiments" / "robustness.yaml"
    said = path.read_text(encoding="utf-8")
    path.write_text(f"{said}# more\n", encoding="utf-8")
    assert numbers.faults(copy) == []  # a comment decides nothing
    path.write_text(said.replace("description: ", "description: Again. ", 1), encoding="utf-8")
    assert len(numbers.faults(copy)) == 1
    keep("results/robustness", "a remark", root=copy)
    assert numbers.faults(copy) == []
    assert load(copy)["results/robustness"].kept == "a remark"
    record("results/robustness", "| | Off |\n|---|---|\n| none | 51 [47, 53], 12 ev. |", root=copy)
    assert numbers.faults(copy) == []
    page = (copy / "docs" / "results.md").read_text("utf-8")
    assert "| none | 51 [47, 53], 12 ev. |\n<!-- end: robustness -->" in page
    result = load(copy)["results/robustness"]
    assert result.figures[0] == Figure("none", "Off", Decimal(51), "", (Decimal(47), Decimal(53)))
    assert (result.commit, result.kept) == ("0123456789ab", "")


def test_numbers_of_sentences_are_taken_from_the_page(copy):
    changed(copy / "docs" / "results.md", "the team dumps 0.8 items", "the team dumps 0.80 items")
    assert len(numbers.faults(copy)) == 1
    take("results/training", root=copy)
    assert numbers.faults(copy) == []
    changed(copy / "docs" / "results.md", "vectors the team dumps", "vectors the team dumped some")
    with pytest.raises(
        ValueError, match="expected once in the prose, with any numbers, got 0 times: With random vectors"
    ):
        take("results/training", root=copy)


def test_a_table_of_results_outside_of_all_blocks_is_found(copy):
    before = (copy / "docs" / "compared.md").read_text(encoding="utf-8")
    for table in (
        "| | costs |\n|---|---|\n| ORCA | cheap, 1.2 [1.1, 1.3] |",
        "| | duration s | said |\n|---|---|---|\n| ORCA | 46 | - |\n| Off | **131** | slow |",
    ):
        (copy / "docs" / "compared.md").write_text(f"{before}\n{table}\n", encoding="utf-8")
        (line,) = numbers.faults(copy)
        assert "expected a block of docs/figures.json, got a table of results" in line


def test_each_exemption_is_needed():
    found = {
        f"{page.relative_to(ROOT).as_posix()}: {table.mark or table.head}"
        for page in numbers.pages()
        for table in result_tables(page.read_text(encoding="utf-8"))
    }
    assert set(numbers.EXEMPT) <= found


def test_a_new_result_needs_a_command(copy):
    with pytest.raises(ValueError, match="network/more: expected the command of a new result, got none"):
        record("network/more", "| | |", root=copy)


def test_a_figure_is_told_rounded_or_as_what_is_saved():
    exact = Figure("", "", Decimal("0.845"), "", (Decimal("0.811"), Decimal("0.880")))
    for value, low, high, unit in (
        ("0.85", "0.81", "0.88", ""),
        ("0.845", "0.811", "0.88", ""),
        ("16", "12", "19", "%"),
    ):
        assert Figure("", "", Decimal(value), unit, (Decimal(low), Decimal(high))).tells(exact)
    for value, low, high, unit in (("0.86", "0.81", "0.88", ""), ("0.85", "0.81", "0.89", ""), ("16", "12", "20", "%")):
        assert not Figure("", "", Decimal(value), unit, (Decimal(low), Decimal(high))).tells(exact)
