"""Decision periods: robots hold their options for as long, and mistakes are one line."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import Batch
from tests.train.commands import told
from train.evaluation.family import FamilyEvaluation
from train.evaluation.trial_task import variants_of
from train.request import Request


def test_a_fixed_option_costs_the_same_and_chance_does_not():
    evaluation = FamilyEvaluation(Request("random", ("Random", "fixed:ORCA"), 1, scenarios=2), periods=(1.0, 0.2, 5.0))
    records = [record for task in evaluation.tasks({}) for record in task.run()]
    [grid] = evaluation.publication(records).grids
    cells = {label: cells for label, *cells in grid.rows}
    names = [f"{strategy}, {period}" for strategy in ("Random", "fixed:ORCA") for period in ("1 s", "0.2 s", "5 s")]
    assert sorted(cells) == sorted(names)
    cost = cells["fixed:ORCA, 1 s"][1]
    same = ["0%", cost, "1.000", "[1.000, 1.000]"]
    assert [cells[name] for name in names[3:]] == [["0%", cost, "1", ""], same, same]
    assert [note.partition(";")[0] for note in grid.notes[1:]] == ["2 scenarios: no statement"]
    assert len({tuple(cells[name]) for name in names[:3]}) == 3


def test_options_are_held_for_a_period():
    batch = Batch(variants_of(load_family("random"), [4.0])["4 s"].mission)
    batch.reset([1])
    options = np.arange(batch.rows)
    held = [worlds.coordinators[0].held.copy() for worlds in batch.ticks(options)]
    assert len(held) == 4.0 / batch.period
    assert all(np.array_equal(each, options) for each in held)


def test_what_is_missing_is_done_and_a_run_can_be_repeated(tmp_path, capsys):
    words = ["study", "periods", "random", "--strategy", "Random", "--scenarios", 2, "--workers", 1]
    words += ["--period", 1, "--period", 2, "--output", tmp_path / "run"]
    assert told(capsys, *words)[0] == 0
    table, journal = (tmp_path / "run" / "table.md").read_text(), tmp_path / "run" / "runs.jsonl"
    journal.write_text("".join(journal.read_text().splitlines(keepends=True)[:3]))
    assert told(capsys, *words, "--resume")[0] == 0
    assert (tmp_path / "run" / "table.md").read_text() == table
    repeated = ["explain", tmp_path / "run", "--condition", "2 s - Random", "--robot", 0, "--time", 1]
    assert told(capsys, *repeated)[0] == 0


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--period", "1", "--period", "0.25"), "--period: decision_period: expected a whole multiple of the control"),
        (("--period", "1", "--period", "1"), "--period: expected at least two different ones, got [1.0, 1.0]"),
        (("--period", "2"), "--period: expected at least two different ones, got [2.0]"),
        (("--period", "1", "--period", "2", "--scenarios", "1"), "--scenarios: expected"),
    ],
)
def test_mistakes_are_one_line(capsys, words, line):
    code, _, error = told(capsys, "study", "periods", "random", "--strategy", "Random", *words)
    assert code == 2
    assert line in error
    assert error.count("\n") == 1
