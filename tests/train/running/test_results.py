"""The directory of results: nothing finished is lost, nothing of others is overwritten."""

import csv
import json

import pytest

from clean_swarm_env.config.errors import ConfigurationError
from tests.train.records import record
from train.running.results import COLUMNS, Results, default_directory, natural_order, write_atomically

MANIFEST = {"identity": {"experiment": "x", "seed": 3, "configuration": {"mission": {"name": "m"}, "starts": [1, 2]}}}


def _rows(directory):
    with (directory / "runs.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_columns_are_those_of_the_issue():
    assert (
        *("experiment", "scenario", "seed", "condition", "completed", "duration_s", "collision_samples_per_s"),
        *("collision_events_per_s", "garbage_done", "robots", "ticks", "items_per_min", "cost_s", "wall_s"),
    ) == COLUMNS


def test_every_finished_run_is_on_the_disk_at_once(tmp_path):
    results = Results(tmp_path / "new" / "r", MANIFEST, resume=False)
    results.add(record("1", "a", 0.1 + 0.2))
    lines = (results.directory / "runs.jsonl").read_text().splitlines()
    assert [json.loads(line)["duration_s"] for line in lines] == [0.1 + 0.2]
    assert float(_rows(results.directory)[0]["duration_s"]) == 0.1 + 0.2
    assert json.loads((results.directory / "manifest.json").read_text()) == MANIFEST


def test_runs_are_sorted_in_the_end_whatever_their_order(tmp_path):
    keys = [("10", "a"), ("2", "b"), ("2", "a"), ("1", "b")]
    contents = []
    for name, order in (("one", keys), ("two", keys[::-1])):
        results = Results(tmp_path / name, MANIFEST, resume=False)
        for key in order:
            results.add(record(*key))
        results.close()
        contents.append([(results.directory / file).read_bytes() for file in ("runs.csv", "runs.jsonl")])
        assert [(r["scenario"], r["condition"]) for r in _rows(results.directory)] == sorted(
            keys, key=lambda key: (int(key[0]), key[1])
        )
    assert contents[0] == contents[1]


def test_resuming_knows_the_finished_runs_and_drops_a_line_cut_off(tmp_path):
    results = Results(tmp_path, MANIFEST, resume=False)
    results.add(record("1"))
    results.add(record("2"))
    journal = tmp_path / "runs.jsonl"
    journal.write_bytes(journal.read_bytes()[:-20])
    again = Results(tmp_path, MANIFEST, resume=True)
    assert again.records == [record("1")]
    again.add(record("2"))
    assert Results(tmp_path, MANIFEST, resume=True).records == [record("1"), record("2")]


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize("name", ["notes.txt", "manifest.json", ".hidden"])
def test_a_directory_with_other_files_is_refused(tmp_path, name, resume):
    (tmp_path / name).write_text("{}")
    with pytest.raises(ConfigurationError, match="holds other files; expected an empty or a new directory"):
        Results(tmp_path, MANIFEST, resume=resume)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [(name, "{}")]


def test_results_are_not_overwritten_without_resume(tmp_path):
    Results(tmp_path, MANIFEST, resume=False).add(record())
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(ConfigurationError, match="holds results of this experiment already; give --resume"):
        Results(tmp_path, MANIFEST, resume=False)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"seed": 4}, "holds other results: seed: expected 4, got 3"),
        (
            {"configuration": {"mission": {"name": "n"}, "starts": [1, 2]}},
            "configuration.mission.name: expected 'n', got 'm'",
        ),
        ({"configuration": {"mission": {"name": "m"}, "starts": [1, 3]}}, "configuration.starts differ"),
    ],
)
@pytest.mark.parametrize("resume", [False, True])
def test_results_of_something_else_are_named(tmp_path, change, expected, resume):
    Results(tmp_path, MANIFEST, resume=False)
    with pytest.raises(ConfigurationError, match="holds other results") as caught:
        Results(tmp_path, {"identity": MANIFEST["identity"] | change}, resume=resume)
    assert expected in str(caught.value)


def test_a_broken_journal_and_a_file_in_place_of_the_directory_are_errors(tmp_path):
    Results(tmp_path / "r", MANIFEST, resume=False)
    (tmp_path / "r" / "runs.jsonl").write_text('{"experiment": 3}\n')
    with pytest.raises(ConfigurationError, match=r"runs\.jsonl: line 1: expected a finished run"):
        Results(tmp_path / "r", MANIFEST, resume=True)
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigurationError, match="expected a directory for the results, got a file"):
        Results(tmp_path / "file", MANIFEST, resume=False)
    with pytest.raises(ConfigurationError, match="cannot be written"):
        Results(tmp_path / "file" / "below", MANIFEST, resume=False)


def test_default_directories_are_numbered_and_resumed_last(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first, second = default_directory("t", resume=False), default_directory("t", resume=True)
    assert first == second
    first.mkdir(parents=True)
    following = default_directory("t", resume=False)
    assert following.name == "t-2"
    assert default_directory("t", resume=True) == first
    following.mkdir()
    assert default_directory("t", resume=True) == following


def test_writing_replaces_the_whole_file_and_leaves_no_parts(tmp_path):
    write_atomically(tmp_path / "x", b"long content")
    write_atomically(tmp_path / "x", b"short")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("x", b"short")]


def test_scenarios_sort_by_their_numbers():
    assert sorted(["10", "9", "case-10", "case-9", "b", "a1b"], key=natural_order) == [
        "9",
        "10",
        "a1b",
        "b",
        "case-9",
        "case-10",
    ]
