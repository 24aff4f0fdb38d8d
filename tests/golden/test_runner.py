"""The original's recorded numbers are matched, and the golden runner notices what differs."""

import json
import lzma
import math
import re

import pytest

from tests.golden.__main__ import PARTS, main
from tests.golden.case import difference
from tests.golden.runner import find_files, replay_file
from tests.paths import ROOT

COUNTS = {"first": (1049, 57), "second": (250, 4), "third": (3, 14)}
"""Part -> cases that agree, and those that are set aside by a number of docs/quirks.md or of the README of the data."""
FILES = [path for part in PARTS for path in find_files(part)]


@pytest.fixture(scope="module")
def outcomes():
    """What came of each file."""
    return {path: replay_file(path) for path in FILES}


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}-{path.name.partition('.')[0]}")
def test_the_original_is_matched(outcomes, path):
    assert outcomes[path].differences == []
    pages = (ROOT / "docs" / "quirks.md").read_text() + (ROOT / "tests" / "golden" / "data" / "README.md").read_text()
    explained = re.findall(r"^\*\*([QMB]\d+)\*\*", pages, re.MULTILINE)
    assert set(outcomes[path].set_aside) <= set(explained)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.name)
def test_no_case_is_missing_and_no_further_one_is_set_aside(outcomes, part):
    found = [outcome for path, outcome in outcomes.items() if path.parent == part]
    agreed, aside = COUNTS[part.name]
    assert sum(outcome.agreed for outcome in found) == agreed
    assert sum(outcome.set_aside.total() for outcome in found) == aside


def test_a_directory_of_other_files_or_none_is_one_line(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"golden: expected golden files (*.json, *.json.xz) in {tmp_path}, got none\n"
    (tmp_path / "weather.json").write_text("[]")
    assert main([str(tmp_path)]) == 2
    assert capsys.readouterr().err.endswith("selection, got weather.json\n")


def test_a_wrong_number_is_a_difference(tmp_path, capsys):
    case = {
        "id": "x", "group": "attractive_balch", "tag": "", "expected": {"vector": [0.5, 0.0, 0.0]},
        "inputs": {
            "function": "attractive_balch", "pose": {"p": [0, 0, 0], "goal_radius": 0.0},
            "gradient": {"p": [1, 0, 0], "goal_radius": 0.0, "diffusion": 2.0, "attraction": 1},
        },
    }  # fmt: skip
    (tmp_path / "gradients.json").write_text(json.dumps([case]))
    assert main([str(tmp_path)]) == 0
    case["expected"]["vector"][0] = 0.50001
    (tmp_path / "gradients.json.xz").write_bytes(lzma.compress(json.dumps([case]).encode()))
    assert main([str(tmp_path)]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == "1 agree, 1 differ, 0 set aside"


@pytest.mark.parametrize(("answer", "counts"), [("a", "1 agree, 0"), ("b", "(B9: 1)"), ("c", "0 agree, 1 differ")])
def test_a_tie_is_set_aside_only_where_the_other_one_is_as_good_to_the_last_bit(answer, counts, tmp_path):
    own = {"p": [0.0, 0.0, 0.0], "diffusion": 1.0, "parent": "me", "frame": "robot", "moving": True}
    # an infinite diffusion attracts with no strength, whatever the distance; one of 1e9 m nearly so
    others = [
        {"p": [x, 0.0, 0.0], "diffusion": diffusion, "parent": name, "frame": "f", "moving": False}
        for name, x, diffusion in (("a", 3.0, math.inf), ("b", 4.0, math.inf), ("c", 5.0, 1e9))
    ]
    messages = [{**m, "id": m["parent"], "attraction": 1, "goal_radius": 0.0, "stamp": 0.0} for m in [own, *others]]
    expected = {k: v for k, v in messages["_abc".index(answer)].items() if k != "stamp"}
    ops = [{"op": "store", "time": 0.0, "msg": message} for message in messages]
    ops.append({"op": "query", "call": "max_attractive_gradient", "time": 0.0})
    case = {
        "id": "x", "group": "", "expected": {"results": [{"result": {**expected, "ev_stamp": 0.0}}]},
        "inputs": {"buffer": {"id": "me", "aggregation_distance": 0.0}, "ops": ops},
    }  # fmt: skip
    (tmp_path / "buffer.json").write_text(json.dumps([case]))
    assert counts in str(replay_file(tmp_path / "buffer.json"))


def test_a_choice_by_a_mechanism_is_set_aside_only_where_it_was_a_tie(tmp_path):
    own = {"id": "me", "p": [0.0, 0.0, 0.0], "diffusion": 1.0, "parent": "me", "frame": "robot", "moving": True}
    others = [
        {"id": name, "p": [x, 0.0, 0.0], "diffusion": 1.0, "parent": name, "frame": "f", "moving": False}
        for name, x in (("a", 3.0), ("b", -3.0), ("c", 4.0))
    ]
    messages = [{**m, "attraction": 1, "goal_radius": 0.0, "stamp": 0.0} for m in [own, *others]]
    inputs = {
        "mechanism": "ChemotaxisBalch", "messages": messages, "time": 0.0,
        "buffer": {"id": "me", "view_distance": 9.0, "aggregation_distance": 0.0},
    }  # fmt: skip
    for vector, counts in (([1.0, 0.0, 0.0], "1 agree"), ([-1.0, 0.0, 0.0], "B9: 1"), ([0.0, 1.0, 0.0], "1 differ")):
        case = {"id": "x", "group": "", "inputs": inputs, "expected": {"vector": vector, "messages": []}}
        (tmp_path / "movement.json").write_text(json.dumps([case]))
        assert counts in str(replay_file(tmp_path / "movement.json"))


def test_differences_are_told_apart():
    assert difference(float("inf"), float("inf")) is None
    assert difference([1.0, None], [1.0 + 1e-9, None]) is None
    assert difference([1.0], [1.0, 2.0])
    assert difference(None, [0.0])
    assert difference(1, True)
