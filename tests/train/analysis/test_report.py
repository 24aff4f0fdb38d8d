"""Summary, tables, figure and the comparison with measured figures."""

import io
import itertools
import json

import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from clean_swarm_env.drawing.look import OPTION_COLOURS
from tests.train.records import experiment, record
from train.analysis.report import ExperimentReport, summary_of
from train.analysis.runs import Runs
from train.reports.charts import picture_of
from train.reports.experiment_tables import all_tables, ratios, table_1
from train.reports.figures import draw_experiment
from train.reports.text_table import TerminalTable, markdown


def report_of(given, records, measured=None, own_starts=False):
    names = {one.name: (one.name,) for one in given.conditions}
    runs = Runs(given, "", 3, tuple((start.id,) for start in given.starts), names, records)
    return ExperimentReport(runs, measured or {}, own_starts)


def _report(scenarios=4, conditions=("a", "b"), measured=None, scale=2.0, own_starts=False, **changes):
    given = experiment(conditions, scenarios, **changes)
    factor = {name: scale ** (len(conditions) - 1 - c) for c, name in enumerate(conditions)}
    records = [record(s.id, c, factor[c] * (10.0 + int(s.id))) for s in given.starts for c in conditions]
    return report_of(given, records, measured or {}, own_starts)


def test_the_summary_has_the_form_of_the_issue():
    content = json.loads(json.dumps(summary_of(_report(conditions=("a", "b", "c")))))
    assert set(content["conditions"]) == {"a", "b", "c"}
    for figures in content["conditions"].values():
        assert (figures["n"], figures["completed"]) == (4, 4)
        for metric in ("duration_s", "collision_samples_per_s", "collision_events_per_s"):
            assert set(figures[metric]) == {"mean", "median", "std", "ci95"}
            low, high = figures[metric]["ci95"]
            assert low < figures[metric]["mean"] < high
    pairs = [(c["a"], c["b"], c["metric"]) for c in content["comparisons"]]
    metrics = ("duration_s", "collision_samples_per_s", "collision_events_per_s")
    assert pairs == [(*pair, metric) for pair in itertools.combinations("abc", 2) for metric in metrics]
    assert all(set(c) == {"a", "b", "metric", "ratio", "ci95", "p"} for c in content["comparisons"])
    assert content["comparisons"][0]["ratio"] == pytest.approx(2.0)
    assert content["comparisons"][0]["p"] is None  # four scenarios


def test_ratios_say_who_left_missions_unfinished_and_that_few_scenarios_say_nothing():
    given = experiment(scenarios=5)
    records = [record(s.id, c, 10.0 * int(s.id), completed=c == "a" or s.id != "3") for s in given.starts for c in "ab"]
    table = ratios(report_of(given, records))
    assert [row[2] for row in table.rows] == ["0% / 20%"] * 3
    assert table.rows[0][5] == "-"
    assert table.notes == ("p: 7 scenarios may tell something",)
    enough = ratios(_report(8))
    assert enough.notes == ()
    assert float(enough.rows[0][5]) == pytest.approx(3 * 2 / 2**8, abs=6e-4)  # of three figures


def test_what_does_not_exist_is_null_and_never_nan():
    given = experiment(scenarios=1)
    none = {"collision_samples_per_s": (0.0, 0.0), "collision_events_per_s": (0.0, 0.0)}
    report = report_of(given, [record("1", c, **none) for c in "ab"])
    content = json.loads(json.dumps(summary_of(report)), parse_constant=pytest.fail)
    assert content["conditions"]["a"]["duration_s"]["ci95"] is None
    assert [(c["ratio"], c["ci95"]) for c in content["comparisons"]] == [(1.0, None), (None, None), (None, None)]
    assert draw_experiment(report)
    assert "| - | - |" in "".join(markdown(grid) for grid in all_tables(report))


def _measured(scenarios, factor=1.0, name="A"):
    figures = {"duration_s": 20.0, "samples_per_s_at_0.55m": 2.0, "events_per_s_at_1.0m": None}
    return {
        s: {name: {key: value and value * factor * (1 + int(s) / 10) for key, value in figures.items()}}
        for s in scenarios
    }


def _with_measured(factor, scenarios=("1", "2", "3", "4")):
    return _report(measured=_measured(scenarios, factor))


@pytest.mark.parametrize(("factor", "agrees"), [(1.0, True), (2.0, False)])
def test_means_agree_with_equal_measured_ones_and_not_with_others(factor, agrees):
    found = {m.content["metric"]: m.content for m in _with_measured(factor).means}
    assert set(found) == {"duration_s", "samples_per_s_at_0.55m"}
    assert found["duration_s"]["ratio"] == pytest.approx(1.0 / factor)
    assert found["duration_s"]["n"] == 4
    assert (abs(found["duration_s"]["ratio"] - 1.0) < 1e-9) == agrees
    if not agrees:
        assert found["duration_s"]["agrees"] is False


def test_only_scenarios_with_measured_figures_count():
    found = _with_measured(1.0, scenarios=("2", "9")).means[0]
    assert (found.content["n"], found.ours, found.theirs) == (1, 24.0, 24.0)
    assert found.agrees is None
    assert not _report(measured=_measured(["7"])).means


def test_ratios_beside_measured_ones_take_the_scenarios_of_both():
    records = [record(str(k), c, 3.0 * k if c == "a" else 1.0 * k) for k in range(1, 5) for c in "ab"]
    measured = {
        str(k): {"A": {"duration_s": 6.0 * k}, **({"B": {"duration_s": 1.0 * k}} if k < 4 else {})} for k in range(1, 5)
    }
    (found,) = report_of(experiment(scenarios=4), records, measured).ratios
    assert [found.content[name] for name in "abn"] == ["a", "b", 3]
    assert found.ours == pytest.approx(3.0)
    assert found.theirs == pytest.approx(6.0)
    assert found.agrees is False  # paired and proportional: both intervals have no width


def test_the_papers_figures_stand_beside_its_own_scenarios_only():
    reference = {"source": "p", "figures": {"a": {"duration_s": [1.5, 2.5, 3.5], "collision_samples_per_s": [1, 2, 3]}}}
    for own in (True, False):
        grid = table_1(_report(3, reference=reference, own_starts=own))
        assert [row[3] for row in grid.rows] == (["1.50", "2.50", "3.50"] if own else ["-"] * 3)
        assert grid.summary[0][3:5] == ("2.50", "2.00")
        assert sum(head.startswith("b") for head in grid.heads) == 2
        assert len(set(grid.heads)) == len(grid.heads)


def test_the_terminal_shows_what_markdown_shows():
    report = _report(3)
    console = Console(width=140, file=io.StringIO(), record=True)
    for grid in all_tables(report):
        console.print(TerminalTable(grid))
        rows = markdown(grid).splitlines()[2:]
        assert len({line.count("|") for line in rows if line.startswith("|")}) == 1
    text = console.export_text()
    for grid in all_tables(report):
        for label, *cells in (*grid.rows, *grid.summary):
            line = next(line for line in text.splitlines() if line.strip("│ ").startswith(label))
            assert all(cell in text for cell in cells), line


def test_many_scenarios_are_left_to_the_file():
    grid = table_1(_report(31))
    console = Console(width=140, file=io.StringIO(), record=True)
    console.print(TerminalTable(grid))
    assert "none of 31 rows; all are in table.md" in console.export_text()
    assert len([line for line in markdown(grid).splitlines() if line.startswith("| 3")]) == 3  # 3, 30 and 31


@pytest.mark.parametrize("scenarios", [1, 5, 100])
def test_the_figure_is_a_picture_with_every_condition(scenarios):
    image = np.asarray(
        Image.open(
            io.BytesIO(picture_of(draw_experiment(_report(scenarios, conditions=("a", "b", "c"))), ".png"))
        ).convert("RGB")
    )
    assert image.shape[0] > 400
    for colour in (tuple(bytes.fromhex(colour[1:])) for colour in OPTION_COLOURS[:3]):
        assert (np.abs(image.astype(int) - colour).sum(axis=-1) < 6).sum() > 50
