"""Training: going on after a kill, what is trained on, what is paid for, mistakes in one line."""

import json
import signal
import subprocess
import sys

import numpy as np
import pytest
from rich.console import Console

from clean_swarm_env.config.load import load_family
from selector.documents.errors import DocumentError
from tests.train.learning.trainings import job, written
from tests.train.waiting import until
from train.learning import session
from train.learning.bandit import BanditTraining
from train.learning.config import LEARNERS, CreditConfig, load_training
from train.learning.credit import Credit
from train.learning.curriculum import VALIDATION_SEED, Curriculum
from train.request import Request

POLICY, BANDIT = ("ppo", "policy/policy.safetensors"), ("bandit", "strategy.safetensors")
RESULTS = {"ppo": POLICY, "both": POLICY, "goals": POLICY, "bandit": BANDIT}
TIMEOUT = 400.0


def command(learner, config, output, *more):
    words = ["train", learner, "--config", str(config), "--seed", "5", "--output", str(output), *more]
    return [sys.executable, "-c", "from train.cli import main; main()", *words]


def finish(words):
    done = subprocess.run(words, capture_output=True, text=True, timeout=TIMEOUT)
    assert done.returncode == 0, done.stderr


@pytest.mark.long
@pytest.mark.extra
@pytest.mark.parametrize("kind", RESULTS)
def test_a_training_that_was_killed_comes_to_the_same_bits(tmp_path, kind):
    pytest.importorskip("stable_baselines3")
    config, (learner, learned) = written(tmp_path, kind, decisions=600), RESULTS[kind]
    finish(command(learner, config, tmp_path / "whole"))
    killed = subprocess.Popen(command(learner, config, tmp_path / "cut"), stderr=subprocess.DEVNULL)
    history = tmp_path / "cut" / "history.jsonl"
    until(lambda: history.is_file() or killed.poll() is not None, TIMEOUT)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    assert len(history.read_text().splitlines()) < 3
    threads = ("--threads", "2") if learner == "ppo" else ()
    finish(command(learner, config, tmp_path / "cut", "--resume", *threads))
    for name in (learned, "history.jsonl"):
        assert (tmp_path / "cut" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name


def test_what_is_not_installed_is_named_with_what_installs_it(tmp_path, monkeypatch):
    monkeypatch.setitem(LEARNERS, "ppo", ("numpy", "no-such-package"))
    request = Request("exploring-ppo", seed=1, output=tmp_path / "t")
    with pytest.raises(DocumentError, match=r"training by ppo needs no-such-package, .*'.\[train\]'"):
        session.run_training("ppo", request, pytest.fail, Console())
    assert not (tmp_path / "t").exists()


def seeds_of(batch, resets):
    """Return the seeds of the scenarios that the worlds of a batch do in some resets."""
    seeds = set()
    for _ in range(resets):
        batch.reset()
        seeds |= {scenario.seed for scenario in batch.doing}
    return seeds


def test_nothing_is_measured_that_was_trained_on(tmp_path):
    config = load_training(str(written(tmp_path, "bandit", validation={"scenarios": 20})), "bandit")
    family, trained = load_family("random"), set()
    for seed in range(3):
        curriculum = Curriculum(config, seed)
        for checkpoint in range(3):
            curriculum.set_scenarios(checkpoint)
            for batch in curriculum.batches:
                trained |= seeds_of(batch, 20)
    assert len(trained) == 3 * 3 * 40  # nor is anything trained on twice
    assert not trained & {scenario.seed for scenario in curriculum.validation["random"]}
    assert all(seed % 2 == 0 for seed in trained)
    assert family.scenario(VALIDATION_SEED, 0, "test").seed % 2 == 1


def test_rewards_are_credited_up_to_the_horizon_and_not_beyond_the_mission():
    credit = Credit(CreditConfig(horizon=3.0, discount=0.5), period=1.0, rows=2, features=1)
    over = np.zeros(2, dtype=bool)
    credit.decide(np.array([0, 1]), np.array([2, 1]), np.array([[0.1], [0.2]]), np.ones(2))
    assert not len(credit.pay(np.array([1.0, 1.0]), over).rows)
    credit.decide(np.array([0]), np.array([0]), np.array([[0.3]]))
    paid = credit.pay(np.array([2.0, 4.0]), np.array([False, True]))
    assert (paid.rows.tolist(), paid.options.tolist(), paid.rewards.tolist()) == ([1], [1], [3.0])
    paid = credit.pay(np.array([4.0, 9.0]), over)
    assert (paid.rows.tolist(), paid.options.tolist(), paid.rewards.tolist()) == ([0], [2], [3.0])
    paid = credit.pay(np.array([8.0, 9.0]), over)
    assert (paid.options.tolist(), paid.rewards.tolist(), paid.contexts.tolist()) == ([0], [6.0], [[0.3]])


TWO_LIBRARIES = {"tasks": [{"family": name, "worlds": 2} for name in ("random", "hotspots")], "goal": "AvoidCollision"}
STRATEGY = {"strategy": {"name": "LinearThompson"}}


@pytest.mark.parametrize(
    ("kind", "learner", "changes", "line"),
    [
        ("bandit", "ppo", {}, "expected a training by ppo, got one by bandit"),
        ("es", "es", {"ppo": {}}, "expected one of ppo, bandit, es, design, got ppo, es"),
        ("es", "es", {"es": None}, "expected one of ppo, bandit, es, design, got none"),
        ("bandit", "bandit", {"bandit": {**STRATEGY, "exported": {"exploring": 0.0}}}, "exploring"),
        ("bandit", "bandit", {"bandit": {**STRATEGY, "exported": {"exploration": -1.0}}}, "exploration"),
        ("bandit", "bandit", TWO_LIBRARIES, "tasks: hotspots: options: expected "),
    ],
)
def test_a_training_that_cannot_be_is_one_line(tmp_path, kind, learner, changes, line):
    with pytest.raises(DocumentError, match=line) as told:
        BanditTraining(job(load_training(str(written(tmp_path, kind, **changes)), learner), tmp_path / "run"))
    assert "\n" not in str(told.value)


def test_an_option_of_one_name_has_the_same_numbers_in_all_tasks(tmp_path):
    for name, view in (("near", 1.0), ("far", 2.0)):
        option = {"name": "Mine", "configuration": "ORCA", "score": 1.0, "parameters": {"view_distance": view}}
        (tmp_path / f"{name}.yaml").write_text(json.dumps({"goals": {"AvoidCollision": [option]}}))
    tasks = [{"family": "random", "worlds": 1, "knowledge": str(tmp_path / f"{name}.yaml")} for name in ("near", "far")]
    config = load_training(str(written(tmp_path, "bandit", tasks=tasks)), "bandit")
    message = (
        "^tasks: AvoidCollision: option 'Mine': expected ORCA {'view_distance': 1.0}, got ORCA {'view_distance': 2.0}"
    )
    with pytest.raises(DocumentError, match=message):
        Curriculum(config, 0)
