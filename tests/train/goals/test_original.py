"""What is known of the original's options stands beside ours, and can be built."""

import pytest

from clean_swarm_env.scenes import goals
from docs.figures import write_original
from selector.configurations.library import Library
from selector.knowledge import load_knowledge
from tests.paths import ROOT

KNOWN = load_knowledge("original")


def test_every_option_of_the_original_can_be_built():
    Library().check(KNOWN)


@pytest.mark.parametrize("goal", goals())
def test_every_goal_is_known_or_said_not_to_be(goal):
    text = (ROOT / "configs" / "knowledge" / "original.yaml").read_text(encoding="utf-8")
    page = (ROOT / "docs" / "original.md").read_text(encoding="utf-8")
    assert (goal in KNOWN.goals) is not any(goal in line for line in text.splitlines() if line.startswith("#   "))
    assert goal in page


def test_the_page_is_written_from_runs(monkeypatch):
    monkeypatch.setattr(write_original, "goals", lambda: ("CircleFormation", "MaxValue"))
    text = write_original.page(runs=1)
    assert "| MaxValue | GossipMax | GossipMax | rounds to agreement | ≤ 6 |" in text
    assert "For CircleFormation the original's choice is not known." in text


def test_the_page_shows_the_option_that_is_taken():
    page = (ROOT / "docs" / "original.md").read_text(encoding="utf-8")
    for goal in KNOWN.goals:
        best = max(KNOWN.options(goal), key=lambda option: option.score)
        assert f"| {goal} | {best.name} |" in page
