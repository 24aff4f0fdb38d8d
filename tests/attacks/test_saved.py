"""Whatever happened to a saved file, it is read as it was, or refused in one line that names it: never a traceback."""

import json

import numpy as np
import pytest

from selector.documents.arrays import load_arrays, save_arrays
from selector.documents.errors import DocumentError
from selector.strategies.learned_file import description_of
from tests.attacks.targets import LINES, RULES, asked, read_strategy
from tests.train.records import record
from train.evaluation.repeat import chosen_options
from train.running.finished_runs import JOURNAL, Results
from train.running.run_folder import CHOSEN_OPTIONS, MANIFEST, RunFolder, read_manifest


@pytest.mark.parametrize("number", [np.nan, np.inf, -1e300])
def test_odd_numbers_in_a_strategy_are_refused(tmp_path, number):
    arrays, description = load_arrays(RULES)
    for name, array in arrays.items():
        changed = array.copy()
        changed.flat[0] = number
        save_arrays(tmp_path / "odd.safetensors", arrays | {name: changed}, description)
        with pytest.raises(DocumentError, match=rf"odd\.safetensors: state '{name}': expected"):
            read_strategy(tmp_path / "odd.safetensors")


def test_a_strategy_of_a_newer_release_says_so(tmp_path):
    arrays, description = load_arrays(RULES)
    path = tmp_path / "newer.safetensors"
    for change in ({"strategy": "Future"}, {"parameters": description["parameters"] | {"future": 1.0}}):
        save_arrays(path, arrays, description | change)
        with pytest.raises(DocumentError, match=r"newer\.safetensors: .*unknown .*newer release may have written it"):
            description_of(path)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"experiment": "y"}, "experiment: expected x, got y"),
        ({"seed": 4}, "seed: expected 3, got 4"),
        ({"seed": True}, "seed"),
        ({"duration_s": 3001.0}, "duration_s: expected at most 3000"),
        ({"duration_s": "Infinity"}, "duration_s"),
        ({"duration_s": -1e300}, "duration_s: expected a number from 0"),
        ({"completed": 1}, "completed"),
        ({"robots": 6}, "robots: expected at most 5"),
        ({"collision_samples_per_s": [1.0]}, "collision_samples_per_s: expected 2 numbers"),
        ({"more": 1}, "expected the keys"),
    ],
)
def test_runs_that_were_not_asked_for_are_refused(tmp_path, changes, message):
    folder = RunFolder(tmp_path / "r", {"identity": {"experiment": "x"}}, resume=False)
    Results(folder, asked).add(record("1", "a"))
    line = json.dumps(record("2", "a").as_mapping() | changes) + "\n"
    (folder.path / JOURNAL).write_text((folder.path / JOURNAL).read_text() + line)
    before = (folder.path / JOURNAL).read_bytes()
    with pytest.raises(DocumentError, match=rf"r/runs\.jsonl: line 2: .*{message}"):
        Results(folder, asked)
    assert (folder.path / JOURNAL).read_bytes() == before


def test_a_run_that_is_kept_twice_is_refused(tmp_path):
    folder = RunFolder(tmp_path / "r", {"identity": {"experiment": "x"}}, resume=False)
    (folder.path / JOURNAL).write_bytes(LINES + LINES)
    with pytest.raises(DocumentError, match=r"line 4: scenario 1, condition a: is there twice"):
        Results(folder, asked)


@pytest.mark.parametrize("odd", [1, "x", [], {"G": 1}, {"G": {"a": 1}}, {"G": {"a": {"count": -1}}}, None])
def test_what_a_manifest_says_was_learned_is_checked(tmp_path, odd):
    content = {"identity": {"experiment": "x"}, "learned": odd}
    (tmp_path / MANIFEST).write_text(json.dumps(content))
    for read in (read_manifest, lambda path: RunFolder(path, {"identity": {"experiment": "x"}}, resume=True)):
        with pytest.raises(DocumentError, match=r"manifest\.json: learned(\.G)?(\.a)?(: count)?.*expected") as error:
            read(tmp_path)
        assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize("line", ["{", "[]", '{"scenario": 1}', '{"scenario": "1", "condition": "a", "options": [1]}'])
def test_damaged_choices_of_a_learning_evaluation_are_one_line(tmp_path, line):
    (tmp_path / CHOSEN_OPTIONS).write_text(line + "\n")
    with pytest.raises(DocumentError, match=rf"{CHOSEN_OPTIONS}: line 1: ") as error:
        chosen_options(tmp_path)
    assert len(str(error.value).splitlines()) == 1
