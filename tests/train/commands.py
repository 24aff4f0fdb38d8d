"""Runs the command line within a test."""

import sys

import pytest

from train import cli


def run(*words: object) -> int:
    """Run a command and return its exit code."""
    patch = pytest.MonkeyPatch()
    patch.setattr(sys, "argv", ["clean-swarm", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    patch.undo()
    return int(ended.value.code or 0)


def told(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    """Run a command; return its exit code, its output and its errors."""
    code = run(*words)
    out, err = capsys.readouterr()
    return code, out, err
