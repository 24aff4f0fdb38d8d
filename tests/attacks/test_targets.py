"""Whatever stands in a document or a saved file, it is read, or refused in one line that names it."""

import pytest

from tests.attacks.targets import FINDINGS, TARGETS, attack


@pytest.mark.parametrize("name", TARGETS)
def test_random_contents_are_read_or_refused_in_one_line(name, tmp_path):
    attack(TARGETS[name](tmp_path), examples=20, number=0)


@pytest.mark.long
@pytest.mark.parametrize("name", TARGETS)
def test_many_random_contents_are_read_or_refused_in_one_line(name, tmp_path):
    attack(TARGETS[name](tmp_path), examples=200)


@pytest.mark.parametrize("finding", sorted(FINDINGS.glob("*/*")), ids=lambda path: f"{path.parent.name}-{path.name}")
def test_what_was_once_found_is_read_or_refused_in_one_line(finding, tmp_path):
    TARGETS[finding.parent.name](tmp_path).read(finding.read_bytes())
