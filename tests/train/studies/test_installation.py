"""Without the extra the core works, and `tune` names what is missing."""

import subprocess
import sys

import pytest

from tests.train.commands import told
from train.studies import config


@pytest.mark.parametrize(
    ("study", "line"),
    [
        (
            "keep-apart",
            "studies need no-such-package, which is not installed: pip install -c constraints.txt '.[tune]'",
        ),
        ("keep-aprt", "did you mean"),  # told before the missing package
    ],
)
def test_a_missing_package_is_one_line_that_names_the_extra(monkeypatch, capsys, study, line):
    monkeypatch.setattr(config, "STUDY_PACKAGES", ("no-such-package",))
    code, _, error = told(capsys, "tune", study)
    assert (code, error.count("\n")) == (2, 1)
    assert line in error


def test_the_command_line_imports_nothing_of_the_extra():
    code = "import sys, train.cli.app, train.studies.config; print({'optuna', 'cmaes'} & sys.modules.keys())"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert shown.strip() == "set()"
