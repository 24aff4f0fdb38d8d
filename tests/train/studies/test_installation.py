"""Without the extra the core works, and the two commands name what is missing."""

import subprocess
import sys

import pytest

from tests.train.commands import run
from train.studies import config


@pytest.mark.parametrize("words", [("tune", "keep-apart"), ("study", "configure", "Off", "--family", "table1")])
def test_a_missing_package_is_named_with_the_extra(monkeypatch, capsys, words):
    monkeypatch.setattr(config, "STUDY_PACKAGES", ("no-such-package",))
    assert run(*words) == 2
    error = capsys.readouterr().err
    assert "studies need no-such-package, which is not installed: pip install -c constraints.txt '.[tune]'" in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("words", [("tune", "keep-aprt"), ("study", "configure", "Off", "--family", "tabel1")])
def test_a_mistake_in_the_words_is_told_before_a_missing_package(monkeypatch, capsys, words):
    monkeypatch.setattr(config, "STUDY_PACKAGES", ("no-such-package",))
    assert run(*words) == 2
    assert "did you mean" in capsys.readouterr().err


def test_the_command_line_imports_nothing_of_the_extra():
    code = "import sys, train.cli.app, train.studies.config; print({'optuna', 'cmaes', 'ribs'} & sys.modules.keys())"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert shown.strip() == "set()"
