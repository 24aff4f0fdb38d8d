"""The help of all commands: few lines in four groups; and the command as it was typed, in the manifest."""

import json
import re

import pytest

from tests.train.commands import told
from train.cli.app import PANELS

KNOWN = ["evaluate", "train", "run", "play", "replay", "explain", "record", "video", "report", "tune", "warm", "list"]
"""Commands that users know by these names."""
GROUPS = {
    "look": {"picture", "draw"},
    "learn": {"knowledge"},
    "study": {"score", "headroom", "claims"},
}


def test_the_help_has_four_groups_of_at_most_eighteen_commands_each_with_its_time(capsys):
    out = told(capsys, "--help")[1]
    panels = re.split(rf"^({'|'.join(PANELS)}):$", out, flags=re.MULTILINE)[1:]
    assert tuple(panels[::2]) == PANELS
    lines = [line for panel in panels[1::2] for line in panel.strip("\n").splitlines() if line]
    assert len(lines) <= 18
    assert {line.split()[0] for line in lines} == {*KNOWN, *GROUPS}
    for line in lines:
        assert re.search(r"\(.*(seconds|min)\)$", line), line
        assert len(line) <= 80, line


@pytest.mark.parametrize("group", GROUPS)
def test_a_group_lists_its_commands(capsys, group):
    _, _, listed = told(capsys, group, "--help")[1].partition("Commands:\n")
    assert {line.split()[0] for line in listed.splitlines() if line[2:3].strip()} == GROUPS[group]


def test_the_manifest_keeps_the_command_as_it_was_typed(fake_missions, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["evaluate", "--scenarios", "1", "--workers", "1", "--output", "my results"]
    assert told(capsys, *words)[0] == 0
    manifest = json.loads((tmp_path / "my results" / "manifest.json").read_text())
    assert manifest["command"] == ["clean-swarm", *words]


@pytest.mark.parametrize("command", ["evaluate", "play", "explain", "replay", "video"])
def test_the_help_says_what_trust_is_for_and_which_folders_configs_has(capsys, command):
    out = " ".join(told(capsys, command, "--help")[1].split())
    assert "--trust" in out
    assert "machines/" in out or command not in ("evaluate", "play")
