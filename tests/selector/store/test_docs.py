"""What docs/knowledge.md shows works."""

import re
import shlex
import sys

import pytest

from tests.paths import ROOT
from train import cli
from train import memory as stores

PAGE = (ROOT / "docs" / "knowledge.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


@pytest.fixture(autouse=True)
def empty_directory(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(stores.VARIABLE, "user.sqlite")


def test_the_program_prints_what_the_page_says_and_the_commands_run_in_their_order(monkeypatch, capsys):
    exec(blocks("python")[0].replace("knowledge.sqlite", "user.sqlite"), {})
    (said,) = re.findall(r"It prints `(.*?)`", PAGE)
    assert capsys.readouterr().out == f"{said}\n"
    commands = [shlex.split(line, comments=True) for line in blocks("sh")[0].splitlines()]
    assert len(commands) == 6
    for words in commands:
        monkeypatch.setattr(sys, "argv", words)
        with pytest.raises(SystemExit) as ended:
            cli.main()
        assert ended.value.code in (0, None), (words, capsys.readouterr().err)
    assert capsys.readouterr().out.endswith("user.sqlite: forgot 2 entries, 0 expert options\n")
