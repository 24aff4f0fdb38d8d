"""The finished runs of an evaluation: none is lost, whenever the program ends."""

import json

import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.types import ConfigurationError
from tests.train.commands import runs
from tests.train.records import record
from train.running.finished_runs import Results, natural_order, runs_of
from train.running.run_folder import RunFolder

MANIFEST = {"identity": {"experiment": "x"}}


def opened(directory, resume=False):
    return Results(RunFolder(directory, MANIFEST, resume=resume))


def test_every_finished_run_is_on_the_disk_at_once(tmp_path):
    results = opened(tmp_path / "new" / "r")
    results.add(record("1", "a", 0.1 + 0.2))
    lines = (results.folder.path / "runs.jsonl").read_text().splitlines()
    assert [json.loads(line)["duration_s"] for line in lines] == [0.1 + 0.2]
    results.close()
    assert float(runs(results.folder.path)[0]["duration_s"]) == 0.1 + 0.2
    assert json.loads((results.folder.path / "manifest.json").read_text())["identity"] == MANIFEST["identity"]


def test_runs_are_sorted_in_the_end_whatever_their_order(tmp_path):
    keys = [("10", "a"), ("2", "b"), ("2", "a"), ("1", "b")]
    contents = []
    for name, order in (("one", keys), ("two", keys[::-1])):
        results = opened(tmp_path / name)
        for key in order:
            results.add(record(*key))
        results.close()
        contents.append([(results.folder.path / file).read_bytes() for file in ("runs.csv", "runs.jsonl")])
        assert [(r["scenario"], r["condition"]) for r in runs(results.folder.path)] == sorted(
            keys, key=lambda key: (int(key[0]), key[1])
        )
    assert contents[0] == contents[1]


def test_resuming_knows_the_finished_runs_and_drops_a_line_cut_off(tmp_path):
    results = opened(tmp_path)
    results.add(record("1"))
    results.add(record("2"))
    journal = tmp_path / "runs.jsonl"
    journal.write_bytes(journal.read_bytes()[:-20])
    again = opened(tmp_path, resume=True)
    assert again.records == [record("1")]
    again.add(record("2"))
    assert opened(tmp_path, resume=True).records == [record("1"), record("2")]


def test_a_broken_journal_is_an_error(tmp_path):
    opened(tmp_path)
    (tmp_path / "runs.jsonl").write_text('{"experiment": 3}\n')
    with pytest.raises(ConfigurationError, match=r"runs\.jsonl: line 1: expected a finished run"):
        opened(tmp_path, resume=True)


def test_a_run_of_a_scenario_that_there_is_not_is_an_error(tmp_path):
    opened(tmp_path).add(record("test-0"))
    family = load_family("clustered")
    with pytest.raises(ConfigurationError, match=r"runs\.jsonl: line 1: expected a finished run: .* such as test-3"):
        runs_of(tmp_path / "runs.jsonl", lambda held: str(family.bound(held.scenario)))


def test_scenarios_sort_by_their_numbers():
    names = ["10", "9", "case-10", "case-9", "b", "a1b"]
    assert sorted(names, key=natural_order) == ["9", "10", "a1b", "b", "case-9", "case-10"]


def test_a_text_that_begins_like_a_formula_is_quoted_and_numbers_stay_numbers(tmp_path):
    results = opened(tmp_path / "r")
    for name in ("=1+1", "+x", "-x", "@x", "x=1"):
        results.add(record("1", name))
    results.close()
    assert [row["condition"] for row in runs(tmp_path / "r")] == ["'+x", "'-x", "'=1+1", "'@x", "x=1"]
    assert {float(row["duration_s"]) for row in runs(tmp_path / "r")} == {10.0}
