"""Training: going on after a kill, what is trained on, what is exported, mistakes in one line."""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from rich.console import Console

from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import Batch
from selector.documents.errors import DocumentError
from selector.store import KnowledgeStore
from selector.strategies.policy_file import Network
from tests.clean_swarm_env.courses import mission
from tests.train.learning.trainings import job, written
from train.learning import session
from train.learning.config import LEARNERS, load_training
from train.learning.curriculum import VALIDATION_SEED, Curriculum
from train.learning.lessons import Credit
from train.request import Request

pytest.importorskip("stable_baselines3")

POLICY = ("ppo", "policy/policy.safetensors")
RESULTS = dict.fromkeys(("ppo", "both", "goals"), POLICY)
BANDIT = ("bandit", "strategy.safetensors")
TIMEOUT = 400.0


def command(learner, config, output, *more):
    words = ["train", learner, "--config", str(config), "--seed", "5", "--output", str(output), *more]
    return [sys.executable, "-c", "from train.cli import main; main()", *words]


def finish(words):
    done = subprocess.run(words, capture_output=True, text=True, timeout=TIMEOUT)
    assert done.returncode == 0, done.stderr
    return done


@pytest.mark.parametrize("kind", ["ppo", "both", "goals", "bandit", "missions"])
def test_a_training_that_was_killed_comes_to_the_same_bits(tmp_path, kind):
    config = written(tmp_path, kind)
    learner, learned = RESULTS.get(kind, BANDIT)
    finish(command(learner, config, tmp_path / "whole"))
    killed = subprocess.Popen(command(learner, config, tmp_path / "cut"), stderr=subprocess.DEVNULL)
    history, since = tmp_path / "cut" / "history.jsonl", time.monotonic()
    while not history.is_file():
        assert killed.poll() is None
        assert time.monotonic() < since + TIMEOUT
        time.sleep(0.005)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    assert len(history.read_text().splitlines()) < 3
    threads = ("--threads", "2") if learner == "ppo" else ()
    finish(command(learner, config, tmp_path / "cut", "--resume", *threads))
    for name in (learned, "history.jsonl"):
        assert (tmp_path / "cut" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name


def test_what_is_not_installed_is_named_with_what_installs_it(tmp_path, monkeypatch):
    monkeypatch.setitem(LEARNERS, "ppo", ("torch", "no-such-package"))
    request = Request("exploring-ppo", seed=1, output=tmp_path / "t")
    with pytest.raises(DocumentError, match=r"training by ppo needs no-such-package, .*'.\[train\]'"):
        session.run_training("ppo", request, pytest.fail, Console())
    assert not (tmp_path / "t").exists()


def test_a_training_of_the_other_learner_or_of_an_unknown_name_is_refused(tmp_path):
    with pytest.raises(DocumentError, match="expected a training by ppo, got one by bandit"):
        load_training(str(written(tmp_path, "bandit")), "ppo")
    with pytest.raises(DocumentError, match="unknown training 'generall'"):
        load_training("generall", "ppo")


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
    credit = Credit(rows=2, periods=3, features=1, discount=0.5)
    over = np.zeros(2, dtype=bool)
    credit.decide(np.array([0, 1]), np.array([2, 1]), np.array([[0.1], [0.2]]), np.ones(2))
    assert not len(credit.pay(np.array([1.0, 1.0]), over).rows)
    credit.decide(np.array([0]), np.array([0]), np.array([[0.3]]), np.ones(1))
    paid = credit.pay(np.array([2.0, 4.0]), np.array([False, True]))
    assert (paid.rows.tolist(), paid.options.tolist(), paid.rewards.tolist()) == ([1], [1], [3.0])
    paid = credit.pay(np.array([4.0, 9.0]), over)
    assert (paid.rows.tolist(), paid.options.tolist(), paid.rewards.tolist()) == ([0], [2], [3.0])
    paid = credit.pay(np.array([8.0, 9.0]), over)
    assert (paid.options.tolist(), paid.rewards.tolist(), paid.contexts.tolist()) == ([0], [6.0], [[0.3]])


@pytest.mark.filterwarnings("error")
def test_a_minibatch_that_is_no_part_of_the_rows_is_no_warning(tmp_path):
    from train.learning.ppo.training import PpoTraining

    changes = {"ppo": {"steps": 20, "minibatch": 64, "hidden": [8]}}
    PpoTraining(job(load_training(str(written(tmp_path, "ppo", **changes)), "ppo"), tmp_path / "run"))


@pytest.mark.parametrize("kind", ["ppo", "team", "both", "goals", "velocity"])
def test_the_exported_policy_decides_as_the_trained_one_by_what_a_robot_sees(tmp_path, kind):
    import torch

    from train.learning.ppo.training import PpoTraining

    config = load_training(str(written(tmp_path, kind)), "ppo")
    training = PpoTraining(job(config, tmp_path / "run"))
    training.advance()
    policy, model = training.policy(), training.model.policy
    own = len(policy.spec.observations)
    seen = np.random.default_rng(0).uniform(-1.0, 1.0, (50, *training.normal.observation_space.shape))
    seen = seen.astype(np.float32)
    normal = torch.as_tensor(training.normal.normalize_obs(seen))
    normal = torch.hstack((normal, torch.ones((50, sum(training.envs.counts)))))
    with torch.no_grad():
        expected = model.action_net(model.mlp_extractor.forward_actor(normal)).numpy()
        likeliest = model.get_distribution(normal).mode().numpy().reshape(50, -1)
        values = model.predict_values(normal)
        normal[:, own : seen.shape[1]] = 0.0
        assert torch.equal(model.predict_values(normal), values) == (kind in ("ppo", "goals"))
    heads = Network(policy).heads(seen[:, :own].astype(np.float64))
    assert list(heads) == {"both": ["options", "vector"], "velocity": ["vector"]}.get(kind, ["options"])
    if policy.spec.vector:
        for given in (expected, likeliest):
            given[:, -2:] = given[:, -2:].clip(-1.0, 1.0)
    np.testing.assert_allclose(np.hstack(list(heads.values())), expected, atol=1e-4)
    parts = np.split(heads.get("options", np.zeros((50, 0))), np.cumsum(training.envs.counts)[:-1], axis=1)
    decided = [part.argmax(axis=1)[:, None] for part in parts if training.envs.counts]
    np.testing.assert_allclose(
        np.hstack(decided + [heads[name] for name in heads if name == "vector"]), likeliest, atol=1e-4
    )


def test_an_option_and_a_vector_are_drawn_as_their_densities_say():
    import torch

    from train.learning.ppo.networks import OptionOfEachGoal, OptionsAndVector

    torch.manual_seed(1)
    outputs, deviations = torch.tensor([[0.0, 1.0, 2.0, 0.5, -0.5]]), torch.tensor([-1.0, 0.0])
    drawn = OptionsAndVector(OptionOfEachGoal([3])).proba_distribution(outputs.expand(20_000, -1), deviations)
    actions = drawn.sample()
    option, vector = (
        torch.distributions.Categorical(logits=outputs[:, :3]),
        torch.distributions.Normal(outputs[:, 3:], deviations.exp()),
    )
    expected = option.log_prob(actions[:, 0]) + vector.log_prob(actions[:, 1:]).sum(dim=1)
    torch.testing.assert_close(drawn.log_prob(actions), expected)
    torch.testing.assert_close(drawn.entropy()[:1], option.entropy() + vector.entropy().sum(dim=1))
    shares = torch.bincount(actions[:, 0].long(), minlength=3) / len(actions)
    torch.testing.assert_close(shares, option.probs[0], atol=0.02, rtol=0.0)
    torch.testing.assert_close(actions[:, 1:].mean(dim=0), outputs[0, 3:], atol=0.05, rtol=0.0)
    assert drawn.mode()[0].tolist() == [2.0, 0.5, -0.5]


def test_the_critic_sees_the_state_of_its_world_also_at_the_end_of_a_mission():
    from clean_swarm_env.sb3 import RobotVecEnv
    from train.learning.ppo.worlds import TeamEnv

    batches = [Batch(mission(time_limit=3.0 + k), worlds=2 - k) for k in range(2)]
    own, names = batches[0].observer.width, batches[0].global_state().names
    envs = TeamEnv(RobotVecEnv(batches=batches))
    envs.seed(1)
    seen, ended = envs.reset(), 0
    for period in range(1, 9):
        states = np.concatenate([np.repeat(batch.global_state().now(), 5, axis=0) for batch in batches])
        assert np.array_equal(seen[:, own:], states)
        seen, _, over, infos = envs.step(np.zeros(15, np.int64))
        assert over.tolist() == [period % 3 == 0] * 10 + [period % 4 == 0] * 5
        for row in np.flatnonzero(over):
            last = dict(zip(names, infos[row]["terminal_observation"][own:], strict=True))
            places = [seen[row, own + names.index(f"robot_{row % 5}_{axis}")] for axis in "xy"]
            assert last["time"] == 1.0
            assert [last[f"robot_{row % 5}_{axis}"] for axis in "xy"] != places
            ended += 1
    assert ended == 2 * 10 + 2 * 5


def test_the_states_of_worlds_that_differ_in_size_have_zeros_for_what_they_lack():
    from clean_swarm_env.sb3 import RobotVecEnv
    from train.learning.ppo.worlds import TeamEnv

    batches = [Batch(mission(robots={"count": robots}, time_limit=2.0), worlds=1) for robots in (3, 5)]
    states = [batch.global_state() for batch in batches]
    envs = TeamEnv(RobotVecEnv(batches=batches))
    envs.seed(1)
    rows = envs.reset()
    over, infos = np.zeros(8, bool), []
    while not over.any():
        told = [dict(zip(envs.names, row[-len(envs.names) :], strict=True)) for row in rows]
        for batch, state, seen in zip(batches, states, (told[:3], told[3:]), strict=True):
            expected = dict(zip(state.names, state.now()[0], strict=True))
            assert all(row == {**dict.fromkeys(envs.names, 0.0), **expected} for row in seen), batch.robots
        rows, _, over, infos = envs.step(np.zeros(8, np.int64))
    last = [info["terminal_observation"][-len(envs.names) :] for info in infos]
    assert [row[envs.names.index("time")] for row in last] == [1.0] * 8
    assert [row[envs.names.index("robot_4_works")] for row in last] == [0.0] * 3 + [1.0] * 5


def test_learned_scores_go_to_the_knowledge_store(tmp_path):
    config = written(tmp_path, "bandit", checkpoints=1, validation={"scenarios": 1, "every": 1})
    kept = ("--store", str(tmp_path / "store.sqlite"))
    finish(command("bandit", config, tmp_path / "run", *kept, "--learn"))
    store = KnowledgeStore(str(tmp_path / "store.sqlite"))
    learned = store.contents().learned
    assert {(key.context, key.source) for key in learned} == {("training tiny", "training tiny, seed 5")}
    assert sum(entry.moments.count for entry in learned.values()) > 10


def test_what_a_robot_cannot_take_is_not_taken_and_options_are_kept(tmp_path):
    from train.learning.ppo.training import PpoTraining

    training = PpoTraining(job(load_training(str(written(tmp_path, "goals")), "ppo"), tmp_path / "run"))
    envs, model = training.envs, training.model
    exploring, avoiding = envs.options.values()
    rows = [batch.rows for batch in training.curriculum.batches]
    seen, before = envs.reset(), None
    for period in range(7):
        flags = seen[:, -len(exploring) - len(avoiding) :]
        actions, _ = model.predict(seen)
        assert flags[np.arange(len(seen)), actions[:, 0]].all()
        assert flags[np.arange(len(seen)), len(exploring) + actions[:, 1]].all()
        assert (flags[: rows[0], : len(exploring)].sum(axis=1) == 1).all()  # there is nothing to explore by
        held = period % 3 != 0
        assert (flags[rows[0] :, : len(exploring)].sum(axis=1) == (1 if held else len(exploring))).all()
        if held:
            np.testing.assert_array_equal(actions[:, 0], before)
        seen, _, over, _ = envs.step(actions)
        assert not over.any()
        assert (envs.chosen[rows[0] :, 0] == (not held)).all()
        assert not envs.chosen[: rows[0], 0].any()
        before = actions[:, 0]


def test_a_policy_begins_with_the_option_that_it_is_given(tmp_path):
    from train.learning.ppo.training import PpoTraining

    training = PpoTraining(job(load_training(str(written(tmp_path, "goals")), "ppo"), tmp_path / "run"))
    _, avoiding = training.envs.options.values()
    actions, _ = training.model.predict(training.envs.reset(), deterministic=True)
    assert {avoiding[number] for number in actions[:, 1]} == {"ORCA"}
    wrong = {"ppo": {"start": {"AvoidCollision": "Orca"}}}
    with pytest.raises(DocumentError, match="ppo: start: unknown option 'Orca'") as told:
        PpoTraining(job(load_training(str(written(tmp_path, "ppo", **wrong)), "ppo"), tmp_path / "wrong"))
    assert "\n" not in str(told.value)
    missing = job(
        load_training(str(written(tmp_path, "goals", goal="AvoidCollision+Transport")), "ppo"), tmp_path / "o"
    )
    with pytest.raises(DocumentError, match="goal: unknown goal 'Transport'"):
        PpoTraining(missing)


def test_other_learners_need_the_same_options_everywhere(tmp_path):
    tasks = [{"family": "random", "worlds": 2}, {"family": "hotspots", "worlds": 2}]
    config = written(tmp_path, "bandit", tasks=tasks, goal="AvoidCollision")
    words = command("bandit", config, tmp_path / "run")
    done = subprocess.run(words, capture_output=True, text=True, timeout=TIMEOUT)
    assert "tasks: hotspots: options: expected " in done.stderr
    assert "Traceback" not in done.stderr
