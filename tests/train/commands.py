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
