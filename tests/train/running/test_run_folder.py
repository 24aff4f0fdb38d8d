"""The directory of an evaluation or a training: claimed, recognised, and nothing of others overwritten."""

import json

import pytest

from clean_swarm_env.config.types import ConfigurationError
from train.running.run_folder import RESULTS_FORMAT, RunFolder, default_directory, read_manifest

MANIFEST = {"identity": {"experiment": "x", "seed": 3, "configuration": {"mission": {"name": "m"}, "starts": [1, 2]}}}


def contents(directory):
    return {path: path.read_bytes() for path in directory.iterdir()}


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize("name", ["notes.txt", "manifest.json", ".hidden"])
def test_a_directory_with_other_files_is_refused(tmp_path, name, resume):
    (tmp_path / name).write_text("{}")
    with pytest.raises(ConfigurationError, match="has other files; expected an empty or a new directory"):
        RunFolder(tmp_path, MANIFEST, resume=resume)
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [(name, "{}")]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"seed": 4}, "has other results: seed: expected 4, got 3"),
        (
            {"configuration": {"mission": {"name": "n"}, "starts": [1, 2]}},
            "configuration.mission.name: expected 'n', got 'm'",
        ),
        ({"configuration": {"mission": {"name": "m"}, "starts": [1, 3]}}, "configuration.starts differ"),
    ],
)
@pytest.mark.parametrize("resume", [False, True])
def test_results_of_something_else_are_named(tmp_path, change, expected, resume):
    RunFolder(tmp_path, MANIFEST, resume=False)
    with pytest.raises(ConfigurationError, match="has other results") as caught:
        RunFolder(tmp_path, {"identity": MANIFEST["identity"] | change}, resume=resume)
    assert expected in str(caught.value)


@pytest.mark.parametrize("other", [RESULTS_FORMAT + 1, 0, "x", None, [1] * 1000])
def test_results_of_another_format_are_left_alone(tmp_path, other):
    held = tmp_path / "manifest.json"
    held.write_text(json.dumps({"format": other, **MANIFEST}))
    before = held.read_bytes()
    for read in (read_manifest, lambda path: RunFolder(path, MANIFEST, resume=True)):
        with pytest.raises(
            ConfigurationError, match=r"manifest\.json: format: expected 1, got .* use the Clean Swarm"
        ) as refused:
            read(tmp_path)
        assert "\n" not in str(refused.value)
    assert held.read_bytes() == before


def test_results_from_before_there_were_formats_are_of_the_first(tmp_path):
    (tmp_path / "manifest.json").write_text(json.dumps(MANIFEST))
    assert read_manifest(tmp_path) == MANIFEST


def test_a_file_in_place_of_the_directory_is_an_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ConfigurationError, match="expected a directory for the results, got a file"):
        RunFolder(tmp_path / "file", MANIFEST, resume=False)
    with pytest.raises(ConfigurationError, match="cannot be written"):
        RunFolder(tmp_path / "file" / "below", MANIFEST, resume=False)


def test_entries_that_may_grow_are_all_kept(tmp_path):
    for entries, resume in (({"a": [1]}, False), ({"b": [2]}, True)):
        RunFolder(tmp_path, {"identity": {"seed": 1, "conditions": entries}}, resume=resume)
    held = json.loads((tmp_path / "manifest.json").read_text())
    assert held["identity"]["conditions"] == {"a": [1], "b": [2]}
    before = contents(tmp_path)
    changed = {"identity": {"seed": 1, "conditions": {"a": [3]}}}
    with pytest.raises(ConfigurationError, match=r"has other results: conditions\.a differ"):
        RunFolder(tmp_path, changed, resume=True)
    assert contents(tmp_path) == before


def test_results_are_continued_by_resume_only_and_tuples_are_lists(tmp_path):
    manifest = {"identity": {"seed": 1, "directories": ("a",)}}
    RunFolder(tmp_path, manifest, resume=False)
    before = contents(tmp_path)
    RunFolder(tmp_path, manifest, resume=True)
    with pytest.raises(ConfigurationError, match="has these results already; give --resume"):
        RunFolder(tmp_path, manifest, resume=False)
    assert contents(tmp_path) == before


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
