"""The golden runner itself, and the golden data where it lies beside the project."""

import json

import pytest

from tests.golden.__main__ import main
from tests.golden.case import difference
from tests.golden.registered import FILES
from tests.golden.runner import replay_file
from tests.paths import SHARED

GOLDEN = SHARED / "golden"
SELFORG = ("gradients.json", "buffer.json", "movement.json", "decisions.json")


@pytest.mark.skipif(not GOLDEN.is_dir(), reason="the golden data is not here")
@pytest.mark.parametrize("name", SELFORG)
def test_the_original_is_matched(name):
    outcome = replay_file(GOLDEN / name)
    assert not outcome.failures
    assert outcome.set_aside.total() < 0.1 * outcome.passed


def test_a_directory_without_files_is_an_error(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert "no golden files" in capsys.readouterr().err


def test_a_file_without_a_replayer_is_an_error(tmp_path, capsys):
    (tmp_path / "weather.json").write_text("[]")
    assert main([str(tmp_path)]) == 2
    assert "no replayer for weather.json" in capsys.readouterr().err


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
    assert set(SELFORG) <= set(FILES)
