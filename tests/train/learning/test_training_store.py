"""A training begins with the rewards that a knowledge store holds of its name, and gives back its own."""

import json
import shutil

import numpy as np
import pytest
import yaml

from clean_swarm_env.config.load import load_family
from selector.documents.arrays import load_arrays
from selector.knowledge import load_knowledge
from selector.store import KnowledgeStore, RewardSums
from selector.strategies.problem import Problem
from tests.train.commands import command, done, refused
from tests.train.learning.trainings import unvalidated, written

STRATEGY = {"name": "UCB1", "parameters": {"prior": 0.0}}
BANDIT = {"strategy": STRATEGY, "credit": {"hold": 5.0, "horizon": 10.0}}


TRAIN = ("train", "bandit", "--config", "bandit.yaml")


@pytest.fixture(autouse=True)
def here(monkeypatch, tmp_path):
    """Be in a directory with a training `bandit.yaml`, whose validations run no missions."""
    monkeypatch.chdir(tmp_path)
    unvalidated(monkeypatch)
    written(tmp_path, "bandit", bandit=BANDIT, checkpoints=1, validation={"scenarios": 1}, decisions=200)


def counts(directory):
    """Option -> number of rewards that the strategy of a training counts in the end."""
    arrays, description = load_arrays(directory / "strategy.safetensors")
    return dict(zip(description["options"], arrays["counts"][0].tolist(), strict=True))


def held(context="training tiny"):
    contents = KnowledgeStore("s.sqlite", create=False).contents()
    learned = contents.scores(contents.knowledge("s.sqlite"), context).get("AvoidCollision", {})
    return {name: one.count for name, one in learned.items()}


def test_counts_and_means_go_on_where_another_training_ended(tmp_path):
    done(*TRAIN, "--store", "s.sqlite", "--learn", "--output", "a")
    first = {name: count for name, count in counts(tmp_path / "a").items() if count}
    assert held() == first
    shutil.copy("s.sqlite", "before.sqlite")
    done(*TRAIN, "--store", "s.sqlite", "--learn", "--seed", 1, "--output", "b")
    both = {name: count for name, count in counts(tmp_path / "b").items() if count}
    assert held() == both
    assert sum(both.values()) > sum(first.values())
    known = json.loads((tmp_path / "b/manifest.json").read_text())["learned"]["AvoidCollision"]
    assert {name: one["count"] for name, one in known.items()} == first
    done(*TRAIN, "--store", "before.sqlite", "--seed", 1, "--output", "c")
    assert (tmp_path / "c/strategy.safetensors").read_bytes() == (tmp_path / "b/strategy.safetensors").read_bytes()


def test_the_same_training_is_not_learned_again_and_missions_do_not_mix_in(tmp_path):
    done(*TRAIN, "--store", "s.sqlite", "--learn", "--output", "a")
    before = held()
    line = refused(*TRAIN, "--store", "s.sqlite", "--learn", "--output", "b")
    assert "s.sqlite: holds what 'training tiny by bandit, seed 0' learned already" in line
    assert held() == before
    options = [option.name for option in load_knowledge("avoidance").options("AvoidCollision")]
    sums = RewardSums("AvoidCollision", options)
    sums.record(np.arange(len(options)), np.ones(len(options)))
    KnowledgeStore("other.sqlite").add(sums, source="missions", context="mission random")
    done(*TRAIN, "--store", "other.sqlite", "--output", "c")
    assert (tmp_path / "c/strategy.safetensors").read_bytes() == (tmp_path / "a/strategy.safetensors").read_bytes()


def test_a_family_that_names_a_store_is_refused(tmp_path):
    family = load_family("random").model_dump(mode="json")
    family["mission"]["store"] = "s.sqlite"
    (tmp_path / "f.yaml").write_text(yaml.safe_dump(family))
    config = yaml.safe_load((tmp_path / "bandit.yaml").read_text())
    config["tasks"][0]["family"] = str(tmp_path / "f.yaml")
    (tmp_path / "bandit.yaml").write_text(yaml.safe_dump(config))
    code, _, err = command(*TRAIN, "--output", "a")
    assert code == 2
    assert "family random: mission.store: expected none in a training, see --store" in err


@pytest.mark.extra
def test_a_bandit_and_ppo_update_the_same_scores_from_rewards_and_max_score_reads_both(tmp_path):
    pytest.importorskip("stable_baselines3")
    written(tmp_path, "ppo", checkpoints=1, validation={"scenarios": 1}, decisions=400)
    expert = Problem.of(load_knowledge("avoidance"), "AvoidCollision")
    taken, counted = [expert.scores], []
    for learner in ("bandit", "ppo"):
        words = ("train", learner, "--config", f"{learner}.yaml", "--store", "s.sqlite", "--learn", "--output", learner)
        _, out, _ = command(*words)
        contents = KnowledgeStore("s.sqlite", create=False).contents()
        known = contents.knowledge("s.sqlite")
        problem = Problem.of(known.with_learned(contents.scores(known, "training tiny")), "AvoidCollision")
        best = problem.options[int(problem.scores.argmax())]
        assert f"AvoidCollision: MaxScore takes {best} (before: " in out
        moved = [f"{a:.3g} -> {b:.3g}" for a, b in zip(taken[-1], problem.scores, strict=True)]
        assert all(f"{name} {one}" in out for name, one in zip(problem.options, moved, strict=True))
        taken.append(problem.scores)
        counted.append(sum(one.count for one in contents.scores(known, "training tiny")["AvoidCollision"].values()))
    assert counted[1] > counted[0] > 0
    assert not np.array_equal(taken[1], taken[0])
    assert not np.array_equal(taken[2], taken[1])
