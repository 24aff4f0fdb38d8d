"""`clean-swarm learn dataset`: what is refused in one line, and what a dataset holds where Minari is installed."""

from importlib.util import find_spec

import numpy as np
import pytest

from clean_swarm_env import Batch
from tests.train.commands import run
from train.running import needs

needs_minari = pytest.mark.skipif(find_spec("minari") is None, reason="needs minari: make examples")


@pytest.fixture(autouse=True)
def empty(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--strategy", "fixed"), "--strategy: expected one strategy, such as fixed:OPTION, got 'fixed'"),
        (("--strategy", "policy:a+b"), "--strategy: expected one strategy"),
        (("--missions", 0), "--missions: expected a whole number of at least 1, got 0"),
        (("--seed", -1), "--seed: expected a whole number of at least 0, got -1"),
    ],
)
def test_what_does_not_fit_is_refused(words, message, capsys):
    assert run("learn", "dataset", "swarm/odd-v0", *words) == 2
    assert message in capsys.readouterr().err


@pytest.mark.skipif(find_spec("minari") is not None, reason="Minari is installed")
def test_without_minari_the_command_names_the_extra(capsys):
    assert run("learn", "dataset", "swarm/rule-v0") == 2
    assert "dataset: needs the extra 'minari', pip install 'clean-swarm[minari]'" in capsys.readouterr().err


@needs_minari
def test_missions_that_this_machine_is_too_small_for_are_refused(capsys, monkeypatch):
    monkeypatch.setattr(needs, "memory_of_machine", lambda: 1e6)
    assert run("learn", "dataset", "swarm/rule-v0", "--strategy", "fsm:rule") == 2
    error = capsys.readouterr().err
    assert "10 missions, 1 at a time, of up to 5 robots" in error
    assert error.endswith("; fewer --missions need less\n")


@needs_minari
@pytest.mark.example
def test_a_minari_dataset_has_every_decision_and_says_what_it_holds(capsys):
    import minari

    words = ("learn", "dataset", "swarm/rule-v0", "--strategy", "fsm:rule", "--missions", 2, "--seed", 3)
    assert run(*words) == 0
    assert "2 missions, " in capsys.readouterr().out
    dataset = minari.load_dataset("swarm/rule-v0")
    batch = Batch(family="table1")
    for seed, episode in zip((3, 4), dataset.iterate_episodes(), strict=True):
        seen = [batch.reset([seed]).ravel().copy()]
        for actions, reward in zip(episode.actions, episode.rewards, strict=True):
            step = batch.step(actions)
            assert step.rewards.mean() == pytest.approx(reward)
            seen.append((step.final_observations if batch.finished else step.observations).ravel().copy())
        assert np.array_equal(np.stack(seen), episode.observations)
    text = dataset.storage.metadata["description"]
    assert "2 missions of the family table1, seeds 3 to 4" in text
    assert batch.observer.names[-1] in text
    assert dataset.recover_environment().unwrapped.batch.options == batch.options
    assert run(*words) == 2
    assert "expected a new dataset, 'swarm/rule-v0' is there" in capsys.readouterr().err
    assert run("learn", "dataset", "no name!") == 2
    assert "NAME: expected group/name-v0, got 'no name!'" in capsys.readouterr().err
