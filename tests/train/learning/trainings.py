"""Trainings of some seconds."""

import yaml

from train.learning.training import TrainingJob
from train.request import Request
from train.running.needs import Machine
from train.running.run_folder import RunFolder

COMMON = {
    "name": "tiny",
    "tasks": [{"family": "random", "worlds": 2}],
    "observation": {"terms": ["situation", "crowd"]},
    "checkpoints": 3,
    "decisions": 300,
    "validation": {"scenarios": 1, "every": 3},
}
SMALL = {"steps": 20, "minibatch": 100, "epochs": 2, "hidden": [8]}
KINDS = {
    "ppo": {"ppo": SMALL},
    "goals": {
        "tasks": [{"family": "random", "worlds": 2}, {"family": "hotspots", "worlds": 1}],
        "goal": "ExplorationPatrol+AvoidCollision",
        "ppo": SMALL
        | {"running": ["ExplorationPatrol"], "holds": {"ExplorationPatrol": 3}, "start": {"AvoidCollision": "ORCA"}},
    },
    "bandit": {
        "bandit": {
            "strategy": {"name": "LinearThompson"},
            "context": ["free_near", "carrying_far", "carrying_near"],
            "credit": {"hold": 5.0, "until": ["carrying_far", "carrying_near"], "horizon": 10.0},
        }
    },
    "es": {"es": {"pairs": 1, "opening": 1}, "checkpoints": 2, "decisions": 2},
    "design": {
        "design": {"candidates": 2, "kept": 1, "opening": 1, "race": {"block": 2, "blocks": 1}},
        "checkpoints": 2,
        "decisions": 4,
    },
}


def written(directory, kind, **changes):
    """Write a training."""
    path = directory / f"{kind}.yaml"
    path.write_text(yaml.safe_dump(COMMON | KINDS[kind] | changes))
    return path


def job(config, directory, *, resume=False, workers=1, **more):
    """A training of seed 1 in a new directory, or one to go on with."""
    request = Request(config.name, seed=1, machine=Machine(workers))
    return TrainingJob(config, request, RunFolder(directory, {"identity": {}}, resume=resume), **more)


def unvalidated(monkeypatch):
    """Let validations run no missions."""
    figures = {"random/excess_s": 1.0, "random/completed": 1.0}
    monkeypatch.setattr("train.learning.training.results_on", lambda *_: {})
    monkeypatch.setattr("train.learning.training.figures_of", lambda _: figures)
    monkeypatch.setattr("train.learning.training.excesses", lambda _: {"random": [1.0]})
    monkeypatch.setattr("train.learning.training.best_fixed", lambda *_: ("none", {"random": [1.0]}))
