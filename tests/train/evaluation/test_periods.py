"""Decision periods: robots hold their options for as long, and mistakes are one line."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import Batch
from tests.train.commands import told
from train.evaluation.choosing.periods import PeriodsRequest, periods_table, with_period
from train.evaluation.family import FamilyRequest


def test_a_fixed_option_costs_the_same_and_chance_does_not():
    family = load_family("random")
    request = FamilyRequest("random", ("Random", "fixed:ORCA"), 1, scenarios=2)
    grid = periods_table(PeriodsRequest(family, request, (1.0, 0.2, 5.0)))
    cells = {row.label: [cell for group in row.groups for cell in group] for row in grid.rows}
    names = [f"{strategy}, {period}" for strategy in ("Random", "fixed:ORCA") for period in ("1 s", "0.2 s", "5 s")]
    assert list(cells) == names
    cost = cells["fixed:ORCA, 1 s"][1]
    same = ["0%", cost, "1.000", "[1.000, 1.000]"]
    assert [cells[name] for name in names[3:]] == [["0%", cost, "1", ""], same, same]
    assert [note.partition(";")[0] for note in grid.notes] == ["2 scenarios: no statement"]
    assert len({tuple(cells[name]) for name in names[:3]}) == 3


def test_options_are_held_for_a_period():
    batch = Batch(with_period(load_family("random"), 4.0).mission)
    batch.reset([1])
    options = np.arange(batch.rows)
    held = [worlds.coordinators[0].held.copy() for worlds in batch.ticks(options)]
    assert len(held) == 4.0 / batch.period
    assert all(np.array_equal(each, options) for each in held)


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
    code, _, error = told(capsys, "periods", "random", "--strategy", "Random", *words)
    assert code == 2
    assert line in error
    assert error.count("\n") == 1
