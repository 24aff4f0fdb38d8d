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
from selector.documents.plain import short
from tests.train.commands import done, refused
from tests.train.learning.trainings import job, written
from tests.train.waiting import until
from train.analysis.intervals import Estimate, Ratio
from train.learning import session
from train.learning.bandit import BanditTraining
from train.learning.config import LEARNERS, CreditConfig, load_training
from train.learning.credit import Credit
from train.learning.curriculum import VALIDATION_SEED, Curriculum
from train.learning.yardstick import Validation
from train.request import Request
from train.running.run_folder import RESULTS_FORMAT

POLICY, BANDIT = ("ppo", "policy/policy.safetensors"), ("bandit", "strategy.safetensors")
RESULTS = {"ppo": POLICY, "goals": POLICY, "bandit": BANDIT}
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


@pytest.mark.long
@pytest.mark.extra
def test_seeds_side_by_side_come_to_the_bits_that_each_has_alone_and_go_on_together(tmp_path):
    pytest.importorskip("stable_baselines3")
    config, words = written(tmp_path, "ppo"), ("--seeds", "4-5")
    finish(command("ppo", config, tmp_path / "alone"))
    finish(command("ppo", config, tmp_path / "both", *words))
    (tmp_path / "both/seed-4/checkpoint.pt").unlink()  # as if it had been killed
    (tmp_path / "both/curves.svg").unlink()
    finish(command("ppo", config, tmp_path / "both", *words, "--resume"))
    assert "2 seeds" in (tmp_path / "both/curves.svg").read_text()
    for name in ("policy/policy.safetensors", "history.jsonl"):
        assert (tmp_path / "both/seed-5" / name).read_bytes() == (tmp_path / "alone" / name).read_bytes(), name


@pytest.mark.extra
def test_trainings_of_several_seeds_are_one_row_over_seeds_and_scenarios(tmp_path, monkeypatch):
    pytest.importorskip("torch")
    monkeypatch.chdir(tmp_path)
    config = written(tmp_path, "ppo", tasks=[{"family": "random"}, {"family": "crowded"}])
    excesses, made = np.random.default_rng(1).gamma(5.0, size=(3, 2, 6)), []

    def train(request, folders):
        assert not request.resume
        for seed, folder in folders.items():
            made.append(str(folder))
            learned = dict(zip(("random", "crowded"), excesses[seed - 2].tolist(), strict=True))
            held = Validation(learned=learned, yardstick={name: [5.0] * 6 for name in learned}, held="ORCA")
            folder.mkdir(parents=True)
            (folder / "manifest.json").write_text(
                json.dumps({"format": RESULTS_FORMAT, "identity": {"configuration": {"name": "tiny"}}})
            )
            (folder / "history.jsonl").write_text(json.dumps({"decisions": 9, "random/excess_s": 5.0}) + "\n")
            (folder / "validation.json").write_text(held.model_dump_json())
            yield seed

    monkeypatch.setattr("train.learning.seeds.trained", train)
    words = ("train", "ppo", "--config", config, "--seeds", "2-3,4")
    out = done(*words)
    assert "seed-2: has results already; give --resume" in refused(*words)
    assert made == [f"results/ppo-ppo-seeds2-3,4/seed-{seed}" for seed in (2, 3, 4)]
    whole = excesses.reshape(3, 12)
    low, high = Estimate.of(whole).ci95
    assert f"tiny, 3 seeds: excess {whole.mean():.1f} s a validation mission [{low:.1f}, {high:.1f}]" in out
    low, high = Ratio.of(whole, np.full(12, 5.0)).ci95
    assert f", {whole.mean() / 5.0:.2f} [{low:.2f}, {high:.2f}] times that of ORCA" in out


@pytest.mark.parametrize("seeds", ["a", "1-", "-1", "3-1", "1,1", "1-3,2", "1.5", "1-1000", "1-9" + "9" * 30, "\u0663"])
def test_seeds_that_are_none_are_one_line(tmp_path, monkeypatch, seeds):
    monkeypatch.chdir(tmp_path)
    said = f"--seeds: expected up to 100 different seeds, as in 1-10 or 1,4,7, got {short(seeds)}"
    assert said in refused("train", "ppo", f"--seeds={seeds}")
    assert "--on: expected --seeds with it" in refused("train", "ppo", "--on", "slurm:2")
    assert "--store: expected none with --seeds" in refused("train", "ppo", "--seeds", "1-2", "--store", "s.sqlite")
    assert not list(tmp_path.iterdir())


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
