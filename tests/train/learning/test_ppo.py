"""Policies by PPO: going on after a stop, what is exported, mistakes in one line."""

import numpy as np
import pytest

from selector.documents.errors import DocumentError
from selector.strategies.policy_file import Network
from tests.train.learning.trainings import SMALL, job, unvalidated, written
from train.learning.config import load_training

pytest.importorskip("stable_baselines3")

import torch

from train.learning.ppo.training import PpoTraining

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


def test_the_exported_policy_decides_as_the_trained_one_by_what_a_robot_sees(tmp_path):
    training = training_of("goals", tmp_path)
    training.advance()
    policy, model = training.policy(), training.model.policy
    seen = np.random.default_rng(0).uniform(-1.0, 1.0, (50, len(policy.spec.observations))).astype(np.float32)
    normal = torch.as_tensor(training.normal.normalize_obs(seen))
    normal = torch.hstack((normal, torch.ones((50, sum(training.envs.counts)))))
    with torch.no_grad():
        expected = model.action_net(model.mlp_extractor.forward_actor(normal)).numpy()
        likeliest = model.get_distribution(normal).mode().numpy()
    heads = Network(policy).heads(seen.astype(np.float64))
    assert list(heads) == ["options"]
    np.testing.assert_allclose(heads["options"], expected, atol=1e-4)
    parts = np.split(heads["options"], np.cumsum(training.envs.counts)[:-1], axis=1)
    assert np.array_equal(np.stack([part.argmax(axis=1) for part in parts], axis=1), likeliest)


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
