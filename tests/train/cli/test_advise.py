"""What `clean-swarm advise` makes of its words."""

import json

import pytest

from train.cli.advise import use_of, with_other_starts
from train.request import Request


@pytest.mark.parametrize(("before", "asked", "expected"), [(0, 0, 1), (0, 5, 5), (5, 5, 6)])
def test_scores_of_an_advice_are_judged_on_starts_that_it_did_not_do(before, asked, expected, tmp_path):
    (tmp_path / "manifest.json").write_text(json.dumps({"identity": {"seed": before}}))
    assert with_other_starts(Request("yard", seed=asked, knowledge=str(tmp_path))).seed == expected


def test_other_knowledge_leaves_the_seed():
    assert with_other_starts(Request("yard", knowledge="avoidance")).seed == 0
    assert with_other_starts(Request("yard")).seed == 0


def test_the_line_of_use_has_starts_that_the_advice_did_not_do(tmp_path):
    assert " --seed 4" in use_of("yard", tmp_path, (), 4, family=True)[0]
