"""What came before, tried with our terms: the ladder, learning at meetings, and the missions that the page tells of."""

import numpy as np
import pytest

from clean_swarm_env.testing import check_strategy
from docs.comparison.prior import missions, write
from docs.comparison.prior.manifest import PriorManifest
from docs.comparison.prior.missions import do_missions, read_missions
from docs.comparison.prior.tables import PriorTables
from examples.conflicts import AtMeetings, ByShares, EffortLadder
from selector.documents.reading import read_mapping
from selector.strategies.problem import Problem
from selector.strategies.registry import STRATEGIES, create

OURS = {kind.__name__: STRATEGIES._classes.pop(kind.__name__) for kind in (EffortLadder, ByShares)}
"""Strategies of the example; tests of the library's own collect all that are registered."""
PROBLEM = Problem("AvoidCollision", ("wide", "other", "never", "narrow"), np.array([0.0, 1.0, 0.0, 0.0]))
LADDER = {"rungs": "never/narrow/wide", "up": 1.0, "down": 0.5}
NOTHING = np.zeros((2, 0))
SMALL = {"family": "random-bumpers", "robots": 3, "scenarios": 2}
GREEDY = "EpsilonGreedy:epsilon=0.5,prior=0,sharing=robot"
TRIED = {
    "goal": "AvoidCollision",
    "fixed": ("ORCA", "PredictiveSteering"),
    "seed": 5,
    "shares_of": "aligned",
    "effort": {
        "entrants": {"quick": {"strategy": "EffortLadder:rungs=ORCA/PredictiveSteering", "paid": "collided"}},
        "compared": [("quick", "best")],
        "places": {"three": SMALL},
    },
    "learned": {
        "entrants": {"aligned": {"strategy": GREEDY, "paid": "aligned"}, "own": {"strategy": GREEDY, "paid": "own"}},
        "compared": [("aligned", "own"), ("roles", "mixture")],
        "places": {"learned": SMALL | {"practice": 1}},
    },
}


@pytest.fixture(autouse=True)
def strategies_of_the_example(monkeypatch):
    monkeypatch.setattr(STRATEGIES, "_classes", STRATEGIES._classes | OURS)


@pytest.mark.parametrize("kind", [EffortLadder, ByShares])
def test_the_strategies_keep_the_contract(kind):
    check_strategy(kind)


def test_a_ladder_climbs_by_conflicts_and_comes_down_without():
    ladder = create("EffortLadder", PROBLEM, np.arange(2, dtype=np.uint64), LADDER, groups=np.arange(2))
    taken = []
    for conflicts in (1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0):
        options = ladder.select(NOTHING)
        taken.append(PROBLEM.options[options[0]])
        assert PROBLEM.options[options[1]] == "never"  # the other robot has no conflicts
        ladder.update(options, np.array([-conflicts, 0.0]), NOTHING)
    assert taken == ["never", "never", "narrow", "narrow", "wide", "narrow", "narrow", "never"]
    with pytest.raises(ValueError, match=r"EffortLadder: rungs: .*'high'.*known: wide"):
        create("EffortLadder", PROBLEM, np.arange(2, dtype=np.uint64), {"rungs": "never/high"})


def test_robots_choose_at_meetings_and_are_paid_for_the_time_between():
    strategy = create("EpsilonGreedy", PROBLEM, np.arange(2, dtype=np.uint64), {"prior": 0.0}, groups=np.arange(2))
    chooser = AtMeetings(strategy, least=2)
    chooser.reset(np.arange(2), seed=1)
    first = chooser.options.copy()
    for met in ([True, False], [False, False], [True, False]):
        chooser.go_on(np.array(met), np.array([0.6, 0.6]))
    assert strategy.counts.sum(axis=1).tolist() == [1.0, 0.0]  # not after one period, and nobody without a meeting
    assert strategy.means[0, first[0]] == pytest.approx(-0.6)


def test_missions_are_done_once_and_roles_hold_what_was_learned(tmp_path, monkeypatch):
    file, manifest = tmp_path / "prior.jsonl", PriorManifest(**TRIED)
    do_missions(manifest, file)
    whole, done = file.read_bytes(), read_missions(file)
    assert [label for place, label in done if place == "learned"][-2:] == ["roles", "mixture"]
    assert done["three", "ORCA"] == done["learned", "ORCA"]
    assert all(0.0 < one.coordination < 1.0 for own in done.values() for one in own)
    for learned, own in zip(done["learned", "aligned"], done["learned", "roles"], strict=True):
        assert own.roles == learned.roles
        assert own.shares == pytest.approx(np.eye(2)[learned.roles].mean(axis=0).tolist())
    assert [*PriorTables(manifest, done).tables()] == ["correlation", "effort", "learned", "ablated"]
    lines = whole.decode().splitlines()
    file.write_text("\n".join(lines[:-1]))
    do_missions(manifest, file)
    assert file.read_bytes() == whole
    monkeypatch.setattr(missions, "_do", None)
    do_missions(manifest, file)  # nothing is missing


def test_the_tables_say_what_the_kept_missions_say():
    manifest = PriorManifest(**read_mapping(write.OWN))
    tables = PriorTables(manifest, read_missions(write.OWN.with_suffix(".jsonl"))).tables()
    assert write.TABLES.read_text(encoding="utf-8") == write.as_text(tables)
