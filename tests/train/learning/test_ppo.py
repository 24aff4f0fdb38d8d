"""Policies by PPO: going on after a stop, what is exported, what the critic sees, mistakes in one line."""

import numpy as np
import pytest

from clean_swarm_env.learning.batch import Batch
from selector.documents.errors import DocumentError
from selector.strategies.policy_file import Network
from tests.clean_swarm_env.courses import mission
from tests.train.learning.trainings import SMALL, job, unvalidated, written
from train.learning.config import load_training

pytest.importorskip("stable_baselines3")

import torch

from clean_swarm_env.sb3 import RobotVecEnv
from train.learning.ppo.networks import OptionOfEachGoal, OptionsAndVector
from train.learning.ppo.training import PpoTraining
from train.learning.ppo.worlds import TeamEnv

pytestmark = pytest.mark.extra


def training_of(kind, directory, *, resume=False, **changes):
    """Return a training, which writes into a directory `run`."""
    return PpoTraining(
        job(load_training(str(written(directory, kind, **changes)), "ppo"), directory / "run", resume=resume)
    )


@pytest.mark.filterwarnings("error")
def test_a_minibatch_that_is_no_part_of_the_rows_is_no_warning(tmp_path):
    training_of("ppo", tmp_path, ppo=SMALL | {"minibatch": 64})


def test_a_training_that_was_stopped_comes_to_the_same_bits(tmp_path, monkeypatch):
    unvalidated(monkeypatch)
    files = {}
    for name, stops in (("whole", False), ("cut", True)):
        (tmp_path / name).mkdir()
        training = training_of("goals", tmp_path / name, checkpoints=2)
        training.advance()
        if stops:
            training = training_of("goals", tmp_path / name, checkpoints=2, resume=True)
            assert training.checkpoint == 1
        training.advance()
        assert training.finished
        training.export("command")
        kept = ("policy/policy.safetensors", "history.jsonl")
        files[name] = [(tmp_path / name / "run" / file).read_bytes() for file in kept]
    assert files["cut"] == files["whole"]


@pytest.mark.parametrize("kind", ["both", "goals", "velocity"])
def test_the_exported_policy_decides_as_the_trained_one_by_what_a_robot_sees(tmp_path, kind):
    training = training_of(kind, tmp_path)
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
        assert torch.equal(model.predict_values(normal), values) == (kind == "goals")
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


def test_what_a_robot_cannot_take_is_not_taken_and_options_are_kept(tmp_path):
    training = training_of("goals", tmp_path)
    envs, model = training.envs, training.model
    exploring, avoiding = envs.options.values()
    rows = [batch.rows for batch in training.curriculum.batches]
    training.curriculum.set_scenarios(0)
    seen, before = envs.reset(), None
    there = np.flatnonzero(training._working()[rows[0] :]) + rows[0]  # others have no choice
    assert 0 < len(there) < len(seen) - rows[0]
    for period in range(7):
        flags = seen[:, -len(exploring) - len(avoiding) :]
        actions, _ = model.predict(seen)
        assert flags[np.arange(len(seen)), actions[:, 0]].all()
        assert flags[np.arange(len(seen)), len(exploring) + actions[:, 1]].all()
        assert (flags[: rows[0], : len(exploring)].sum(axis=1) == 1).all()  # there is nothing to explore by
        held = period % 3 != 0
        assert (flags[there, : len(exploring)].sum(axis=1) == (1 if held else len(exploring))).all()
        if held:
            np.testing.assert_array_equal(actions[:, 0], before)
        seen, _, over, _ = envs.step(actions)
        assert not over.any()
        assert (envs.chosen[there, 0] == (not held)).all()
        assert not envs.chosen[: rows[0], 0].any()
        before = actions[:, 0]


def test_a_policy_begins_with_the_option_that_it_is_given(tmp_path):
    training = training_of("goals", tmp_path)
    _, avoiding = training.envs.options.values()
    actions, _ = training.model.predict(training.envs.reset(), deterministic=True)
    assert {avoiding[number] for number in actions[:, 1]} == {"ORCA"}


@pytest.mark.parametrize(
    ("kind", "changes", "line"),
    [
        ("ppo", {"ppo": {"start": {"AvoidCollision": "Orca"}}}, "ppo: start: unknown option 'Orca'"),
        ("goals", {"goal": "AvoidCollision+Transport"}, "goal: unknown goal 'Transport'"),
    ],
)
def test_a_training_that_cannot_be_is_one_line(tmp_path, kind, changes, line):
    with pytest.raises(DocumentError, match=line) as told:
        training_of(kind, tmp_path, **changes)
    assert "\n" not in str(told.value)
