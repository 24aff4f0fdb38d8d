"""The golden runner itself, and the golden data where it lies beside the project."""

import json
import re

import pytest

from tests.golden.__main__ import main
from tests.golden.case import difference
from tests.golden.runner import replay_file
from tests.paths import ROOT, SHARED


def recorded_files():
    """Return a parameter for each file of both parts, one that skips for a part that is not here."""
    files = []
    for part in ("golden", "golden-2"):
        found = sorted((SHARED / part).glob("*.json"))
        files += [pytest.param(path, id=f"{part}/{path.stem}") for path in found]
        if not found:
            files.append(pytest.param(None, id=part, marks=pytest.mark.skip(reason="the recorded cases are not here")))
    return files


@pytest.mark.parametrize("path", recorded_files())
def test_the_original_is_matched(path):
    outcome = replay_file(path)
    assert outcome.failures == []
    assert outcome.set_aside.total() <= 0.1 * outcome.passed + 1
    explained = re.findall(r"^\*\*([QMB]\d+)\*\*", (ROOT / "docs" / "quirks.md").read_text(), re.MULTILINE)
    assert set(outcome.set_aside) <= set(explained)


def test_a_directory_without_files_is_an_error(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert "no golden files" in capsys.readouterr().err


def test_a_file_without_a_replayer_is_an_error(tmp_path, capsys):
    (tmp_path / "weather.json").write_text("[]")
    assert main([str(tmp_path)]) == 2
    assert "no replayer for weather.json" in capsys.readouterr().err


def test_without_a_name_both_parts_are_replayed(tmp_path, capsys):
    parts = [tmp_path / "golden", tmp_path / "golden-2"]
    for part in parts:
        assert main([], parts) == (2 if part == parts[0] else 0)  # without the first part there is nothing to replay
        part.mkdir()
        (part / "selection.json").write_text("[]")
    assert main([], parts) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in lines[-3:-1]] == ["golden/selection.json", "golden-2/selection.json"]


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


def test_differences_are_told_apart():
    assert difference(float("inf"), float("inf")) is None
    assert difference([1.0, None], [1.0 + 1e-9, None]) is None
    assert difference([1.0], [1.0, 2.0])
    assert difference(None, [0.0])
    assert difference(1, True)
