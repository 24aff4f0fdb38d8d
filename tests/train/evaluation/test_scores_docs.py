"""What docs/scores.md shows works, on fewer missions."""

import json
import re
import shlex
import sys

import pytest

from docs.figures.draw_scores import ALONE, LEARN, write_files
from tests.paths import ROOT
from train import cli

PAGE = (ROOT / "docs" / "scores.md").read_text(encoding="utf-8")
FEWER = {"30": "3", "20": "1", "10": "1"}


def test_the_commands_run_in_their_order(monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(tmp_path)
    write_files(tmp_path)
    (block,) = re.findall(r"```sh\n(.*?)```", PAGE, flags=re.DOTALL)
    commands = [[FEWER.get(word, word) for word in shlex.split(line)] for line in block.splitlines()]
    assert len(commands) == 8
    for words in commands:
        monkeypatch.setattr(sys, "argv", words)
        with pytest.raises(SystemExit) as ended:
            cli.main()
        assert ended.value.code in (0, None), (words, capsys.readouterr().err)
    choices = map(json.loads, (tmp_path / "first" / "choices.jsonl").read_text().splitlines())
    taken = [one["options"]["AvoidCollision"] for one in choices]
    assert taken == ["RepulsionFernandez", "RepulsionGradient", "RepulsionFernandez-view0.5"]
    assert "known at the beginning in the context 'mission rooms'" in (tmp_path / "later" / "table.md").read_text()


def test_the_figure_tells_the_story_of_the_page():
    assert f"clean-swarm {LEARN} --scenarios 30 --output first" in PAGE
    assert set(ALONE.split()[:5]) == set(LEARN.split()[:5])
