"""Strategies on a family, by the command line: same results in any number of processes, going on, mistakes."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
import yaml

from selector.knowledge import load_knowledge
from selector.strategies.learned_file import save_strategy
from selector.strategies.policy_file import find_policy, load_policy, save_policy
from selector.strategies.problem import Problem
from selector.strategies.registry import create
from selector.strategies.streams import row_keys
from tests.paths import TRAINED
from tests.train.commands import command, cut, done, refused, runs

FAMILY = {
    "name": "small",
    "description": "Two to four robots and three items.",
    "mission": {"base": "table1", "knowledge": "avoidance", "time_limit": 20.0},
    "robots": [2, 4],
    "items": [3, 3],
}


@pytest.fixture
def family(tmp_path):
    path = tmp_path / "small.yaml"
    path.write_text(yaml.safe_dump(FAMILY))
    return path


@pytest.fixture
def words(family):
    """The beginning of the commands."""
    return "evaluate", family, "--workers", 1


def test_an_evaluation_that_lacks_runs_goes_on_to_the_same_results(words, tmp_path):
    words += ("--strategy", "fixed", "--strategy", "fsm:rule", "--strategy", "Random")
    words += ("--scenarios", 3, "--world-seeds", 2)
    out = done(*words, "--output", tmp_path / "whole", "--all")
    assert "the oracle chose on other world seeds" in out or "no gap" in out
    assert {row["scenario"] for row in runs(tmp_path / "whole")} == {
        f"test-{k}{w}" for k in (1, 2, 3) for w in ("", ".2")
    }
    assert (tmp_path / "whole" / "figure.png").stat().st_size > 1000
    cut(tmp_path / "whole", tmp_path / "cut", slice(None, None, 3))
    done(*words, "--output", tmp_path / "cut", "--resume")
    assert runs(tmp_path / "cut") == runs(tmp_path / "whole")
    summary = json.loads((tmp_path / "whole" / "summary.json").read_text())
    assert summary == json.loads((tmp_path / "cut" / "summary.json").read_text())
    assert set(summary["strategies"]) >= {"fsm:rule", "Random", *summary["best_fixed"]}
    assert "3 scenarios cannot tell " in out
    assert all(one["ratio"]["p"] is None for one in summary["comparison"])


def test_strategies_and_scenarios_can_be_added_later(words, undrawn, tmp_path):
    done(*words, "--strategy", "Random", "--scenarios", 1, "--output", tmp_path / "grown")
    words += ("--strategy", "fsm:rule", "--strategy", "Random", "--scenarios", 2)
    out = done(*words, "--output", tmp_path / "grown", "--resume")
    assert done(*words, "--output", tmp_path / "whole") == out.replace("grown", "whole")
    assert runs(tmp_path / "grown") == runs(tmp_path / "whole")
    manifest = json.loads((tmp_path / "grown" / "manifest.json").read_text())
    assert set(manifest["identity"]["conditions"]) == {"Random", "fsm:rule", "fixed:Off"}


def test_a_strategy_that_was_trained_again_is_another_one(words, undrawn, tmp_path):
    policy = tmp_path / "policy"
    shutil.copytree(find_policy("general", (TRAINED,)), policy)
    words += ("--strategy", f"P=policy:{policy}", "--scenarios", 1, "--output", tmp_path / "results")
    done(*words)
    learned = load_policy(policy)
    learned.weights["options.bias"][0] += 1.0
    save_policy(policy, learned)
    code, _, err = command(*words, "--resume")
    assert code == 2
    assert "has other results: conditions.P.members differ" in err


def test_what_strategies_learned_is_taken_from_their_files(words, undrawn, tmp_path):
    problem = Problem.of(load_knowledge("avoidance"), "AvoidCollision", ("free_far",))
    scores = np.arange(len(problem.options)) == problem.options.index("RepulsionGradient-view0.5")
    told = replace(problem, scores=np.where(scores, 1.0, 0.0))
    keys = row_keys(np.random.SeedSequence(0), 1)
    strategy = create("LinearThompson", told, keys, {"exploration": 0.0})
    for name in ("a", "b"):
        save_strategy(tmp_path / f"{name}.safetensors", strategy)
    files = f"learned:{tmp_path / 'a.safetensors'}+{tmp_path / 'b.safetensors'}"
    words += ("--strategy", files, "--strategy", "fixed:RepulsionGradient-view0.5", "--scenarios", 1)
    done(*words, "--output", tmp_path / "results")
    found = {row.pop("condition"): row for row in runs(tmp_path / "results")}
    assert set(found) == {"learned#1", "learned#2", "fixed:RepulsionGradient-view0.5", "fixed:Off", "Random"}
    assert found["learned#1"] == found["learned#2"] == found["fixed:RepulsionGradient-view0.5"]


@pytest.mark.parametrize(
    ("more", "line"),
    [
        (("--strategy", "UCB2"), "unknown strategy 'UCB2'"),
        (("--strategy", "policy:none"), "unknown policy 'none'"),
        (("--strategy", "learned:none"), "unknown learned strategy 'none'"),
        (("--strategy", "fixed:Nothing"), "unknown option 'Nothing'"),
        (("--strategy", "fsm:rule", "--knowledge", "cleaning"), "options: unknown option 'RepulsionGradient-"),
        (("--condition", "A"), "--condition: expected with an experiment"),
    ],
)
def test_mistakes_are_one_line_and_nothing_is_written(words, tmp_path, more, line):
    assert line in refused(*words, *more, "--output", tmp_path / "none")
    assert not (tmp_path / "none").exists()
