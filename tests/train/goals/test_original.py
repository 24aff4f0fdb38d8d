"""The original's options are compared with ours, and all of them can be built."""

from clean_swarm_env.scenes import goals
from docs.figures import write_original
from selector.configurations.library import Library
from selector.knowledge import load_knowledge
from tests.paths import ROOT

KNOWN = load_knowledge("original")


def test_every_option_of_the_original_can_be_built():
    Library().check(KNOWN)


def test_every_goal_is_known():
    assert set(KNOWN.goals) == set(load_knowledge("library").goals) == set(goals())


def test_the_page_is_written_from_runs(monkeypatch):
    monkeypatch.setattr(write_original, "goals", lambda: ("MaxValue",))
    text = write_original.page(runs=1)
    assert "| MaxValue | GossipMax | GossipMax | rounds to agreement | ≤ 6 |" in text
    assert "Of the 1 goals the original's options meet all targets of 1, the library's of 1." in text


def test_the_page_shows_the_option_that_is_taken():
    page = (ROOT / "docs" / "original.md").read_text(encoding="utf-8")
    for goal in KNOWN.goals:
        best = max(KNOWN.options(goal), key=lambda option: option.score)
        assert f"| {goal} | {best.name} |" in page
