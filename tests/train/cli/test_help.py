"""The help of all commands: few lines in four groups."""

import re

import pytest

from tests.train.commands import done
from train.cli.app import PANELS

KNOWN = ["evaluate", "train", "run", "play", "replay", "explain", "record", "video", "report", "tune", "warm", "list"]
"""Commands that users know by these names."""
GROUPS = {
    "look": {"picture", "draw"},
    "learn": {"knowledge"},
    "study": {"score", "headroom", "claims"},
}


def test_the_help_has_four_groups_of_at_most_eighteen_commands_each_with_its_time():
    out = done("--help")
    panels = re.split(rf"^({'|'.join(PANELS)}):$", out, flags=re.MULTILINE)[1:]
    assert tuple(panels[::2]) == PANELS
    lines = [line for panel in panels[1::2] for line in panel.strip("\n").splitlines() if line]
    assert len(lines) <= 18
    assert {line.split()[0] for line in lines} == {*KNOWN, *GROUPS}
    for line in lines:
        assert re.search(r"\(.*(seconds|min)\)$", line), line
        assert len(line) <= 80, line


@pytest.mark.parametrize("group", GROUPS)
def test_a_group_lists_its_commands(group):
    _, _, listed = done(group, "--help").partition("Commands:\n")
    assert {line.split()[0] for line in listed.splitlines() if line[2:3].strip()} == GROUPS[group]
