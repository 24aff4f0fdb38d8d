"""Learners of a comparison, from two rounds of missions or some hundred decisions: they are trained once and judged."""

import numpy as np
import pytest

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.batch import Batch
from docs.comparison import missions
from docs.comparison.manifest import Manifest
from docs.comparison.missions import do_missions, output_of, read_missions, trained
from docs.comparison.tables import FamilyFigures
from selector.documents.errors import DocumentError
from selector.strategies.policy_file import load_policy
from tests.train.learning.trainings import SMALL, unvalidated, written

pytest.importorskip("stable_baselines3")
pytestmark = [pytest.mark.extra, pytest.mark.long]

TAUGHT = {"fixed": ("ORCA",), "told": {"spots 0 stations 2": "PredictiveSteering"}}
SEEN = {"terms": ["situation", "crowd", "heard"], "remembers": ["heard"]}
ROUNDS = {"rounds": 2, "scenarios": 2, "hidden": (8,)}


def toy(folder, **changes):
    """Return a manifest of four learners that see one family, and are judged on it."""
    training = str(written(folder, "ppo", observation=SEEN, goal="AvoidCollision", ppo=SMALL, checkpoints=1))
    learners = {
        "imitation": {"training": training, "seeds": (1, 2), "imitation": ROUNDS},
        "MAPPO": {"training": training, "seeds": (1,), "critic": "team"},
        "imitated": {"training": training, "seeds": (1,), "start": "imitation"},
    }
    given = {"trained": learners, "seen": {"random": TAUGHT}, "families": {"random": {**TAUGHT, "scenarios": 2}}}
    return Manifest(**{"name": "toy", "goal": "AvoidCollision", "seed": 3, **given, **changes})


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.setattr(missions, "ROOT", tmp_path)
    unvalidated(monkeypatch)
    return tmp_path


def test_learners_are_trained_once_and_each_of_their_trainings_is_judged(place, monkeypatch):
    manifest, file = toy(place), place / "toy.jsonl"
    do_missions(manifest, file)
    found = read_missions(file, manifest)
    runs = ["imitation 1", "imitation 2", "MAPPO", "imitated"]
    assert [label for _, label in found][1:5] == runs
    assert all(found["random", run].training_cpu_s > 0.0 for run in runs)
    assert found["random", "imitation 1"].of == f"training {manifest.trained['imitation'].training}, seed 1"
    told, imitated = found["random", "told"], found["random", "imitation 1"]
    assert np.mean(imitated.excess_s) < 1.3 * np.mean(told.excess_s)
    figures = FamilyFigures.of(manifest, "random", found)
    assert figures.excesses["imitation"].shape == (2, 2, 1)
    monkeypatch.setattr(missions, "_train", None)
    file.unlink()
    do_missions(manifest, file)
    assert [one.excess_s for one in read_missions(file, manifest).values()] == [one.excess_s for one in found.values()]

    files = [output_of(manifest, *own) / "policy" for own in (("imitation", 1), ("imitated", 1), ("MAPPO", 1))]
    first, then, team = map(load_policy, files)
    assert first.spec.observations == then.spec.observations == team.spec.observations
    assert "most_heard_stopped_by_collision" in first.spec.observations
    assert first.spec.probing.sampled
    moved = np.abs(then.weights["options.weight"] - first.weights["options.weight"]).max()
    assert 0.0 < moved < 0.2 < np.abs(team.weights["options.weight"] - first.weights["options.weight"]).max()


def test_equal_seeds_make_equal_networks(place):
    weights = []
    for name in ("toy", "again"):
        manifest = toy(place, name=name)
        trained(manifest, "imitation", 2)
        weights.append((output_of(manifest, "imitation", 2) / "policy" / "policy.safetensors").read_bytes())
    assert weights[0] == weights[1]


def test_mistakes_are_lines_that_say_what_was_expected(place):
    with pytest.raises(ValueError, match="expected an imitation with the same seeds, got 'MAPPO'"):
        toy(place, trained={"PPO": {"training": "one", "seeds": (1,), "start": "MAPPO"}})
    with pytest.raises(ConfigurationError, match="seen: tiny sees an unknown family 'random'"):
        trained(toy(place, seen={}), "imitation", 1)
    manifest = toy(place)
    trained(manifest, "imitation", 1)
    (place / "wider").mkdir()
    changes = {"observation": SEEN, "goal": "AvoidCollision", "ppo": SMALL | {"hidden": [9]}}
    wider = written(place / "wider", "ppo", **changes)
    started = {"training": str(wider), "seeds": (1,), "start": "imitation"}
    learners = {"imitation": manifest.trained["imitation"], "wider": started}
    with pytest.raises(ConfigurationError, match=r"start: hidden: expected \(9,\), got \(8,\)"):
        trained(toy(place, trained=learners), "wider", 1)
    file = output_of(manifest, "imitation", 1) / "policy"
    named = decider_named(f"policy:{file}")
    with pytest.raises(DocumentError, match=r"^observation: terms: heard: expected robots that tell facts.* Foraging$"):
        Batch({"task": "Foraging"}, observation=named.observation(()))
    batch = Batch("table1", observation={"terms": ["situation", "crowd"]})
    with pytest.raises(DocumentError, match=r"^policy: observations: unknown component 'heard_stopped_by_collision'"):
        named.build(DecidedGoal(batch, "AvoidCollision").problem, np.zeros(batch.rows, dtype=np.int64))
