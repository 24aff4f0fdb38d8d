"""The golden runner itself, and the golden data where it lies beside the project."""

import json
import math
import re

import pytest

from tests.golden.__main__ import DIRECTORIES, main
from tests.golden.case import difference
from tests.golden.runner import replay_file
from tests.paths import ROOT, SHARED


def recorded_files():
    """Return a parameter for each file of all parts, one that skips for a part that is not here."""
    files = []
    for part in (path.name for path in DIRECTORIES):
        found = sorted((SHARED / part).glob("*.json"))
        files += [pytest.param(path, id=f"{part}/{path.stem}") for path in found]
        if not found:
            files.append(pytest.param(None, id=part, marks=pytest.mark.skip(reason="the recorded cases are not here")))
    return files


@pytest.mark.parametrize("path", recorded_files())
def test_the_original_is_matched(path):
    outcome = replay_file(path)
    assert outcome.failures == []
    late = path.parent.name == "golden-3"  # only cases that differed are left there
    assert late or outcome.set_aside.total() <= 0.1 * outcome.passed + 1
    explained = re.findall(r"^\*\*([QMB]\d+)\*\*", (ROOT / "docs" / "quirks.md").read_text(), re.MULTILINE)
    assert set(outcome.set_aside) <= set(explained)


def test_a_directory_without_files_is_an_error(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert "no golden files" in capsys.readouterr().err


def test_a_file_without_a_replayer_is_an_error(tmp_path, capsys):
    (tmp_path / "weather.json").write_text("[]")
    assert main([str(tmp_path)]) == 2
    assert "no replayer for weather.json" in capsys.readouterr().err


def test_without_a_name_all_parts_are_replayed(tmp_path, capsys):
    parts = [tmp_path / path.name for path in DIRECTORIES]
    for part in parts:
        assert main([], parts) == (2 if part == parts[0] else 0)  # without the first part there is nothing to replay
        part.mkdir()
        (part / "selection.json").write_text("[]")
    assert main([], parts) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split("/")[0] for line in lines[-4:-1]] == ["golden", "golden-2", "golden-3"]


def test_a_wrong_number_fails(tmp_path, capsys):
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
    (tmp_path / "gradients.json").write_text(json.dumps([case]))
    assert main([str(tmp_path)]) == 1
    assert "0 passed, 1 failed, 0 set aside" in capsys.readouterr().out


@pytest.mark.parametrize(("answer", "counts"), [("a", "1 passed, 0"), ("b", "(B9: 1)"), ("c", "0 passed, 1 failed")])
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
    for vector, counts in (([1.0, 0.0, 0.0], "1 passed"), ([-1.0, 0.0, 0.0], "B9: 1"), ([0.0, 1.0, 0.0], "1 failed")):
        case = {"id": "x", "group": "", "inputs": inputs, "expected": {"vector": vector, "messages": []}}
        (tmp_path / "movement.json").write_text(json.dumps([case]))
        assert counts in str(replay_file(tmp_path / "movement.json"))


def test_differences_are_told_apart():
    assert difference(float("inf"), float("inf")) is None
    assert difference([1.0, None], [1.0 + 1e-9, None]) is None
    assert difference([1.0], [1.0, 2.0])
    assert difference(None, [0.0])
    assert difference(1, True)
