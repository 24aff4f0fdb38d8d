"""What docs/tuning.md shows works."""

import json
import re
import shlex

import pytest

from selector.documents.find import load_file
from tests.paths import ROOT
from tests.train.commands import run
from train.studies.config import StudyConfig

PAGE = (ROOT / "docs" / "tuning.md").read_text(encoding="utf-8")


@pytest.mark.long
@pytest.mark.extra
def test_the_commands_run_in_their_order(monkeypatch, tmp_path, capsys):
    pytest.importorskip("optuna", reason="optuna is not installed (extra tune)")
    monkeypatch.chdir(tmp_path)
    files = re.findall(r"`(my/\S+)`:\n\n```yaml\n(.*?)```", PAGE, flags=re.DOTALL)
    assert len(files) == 2
    for name, text in files:
        path = tmp_path / name
        path.parent.mkdir(parents=True)
        path.write_text(text)
    (block,) = re.findall(r"```sh\n(.*?)```", PAGE, flags=re.DOTALL)
    lines = [shlex.split(line)[1:] for line in block.splitlines()]
    assert [line[line[0] == "learn"] for line in lines] == ["tune", "knowledge", "evaluate"]
    for words in lines:
        more = ["--workers", "1"] if words[0] != "learn" else []
        assert run(*words, *more) == 0, capsys.readouterr().err
    shown = capsys.readouterr().out
    assert "study apart, seed 0" in shown
    strategies = json.loads((next((tmp_path / "results").glob("pairs-seed0*")) / "summary.json").read_text())[
        "strategies"
    ]
    assert {"fixed:apart", "fixed:RepulsionFernandez-view1.5", "fixed:Off"} <= set(strategies)


def test_the_shipped_study_can_be_read():
    assert load_file("studies", "keep-apart", StudyConfig).method == "TPE"
