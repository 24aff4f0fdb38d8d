"""Without the extra the core works, and `tune` names what is missing."""

import pytest

from tests.train.commands import refused
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
def test_a_missing_package_is_one_line_that_names_the_extra(monkeypatch, study, line):
    monkeypatch.setattr(config, "STUDY_PACKAGES", ("no-such-package",))
    assert line in refused("tune", study)
