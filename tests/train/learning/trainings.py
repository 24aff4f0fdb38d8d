"""Trainings of some seconds: `missions` is one by bandit, rewarded by what whole missions cost."""

from dataclasses import replace

import yaml

from tests.selector.strategies.policies import exported
from train.learning.training import TrainingJob
from train.running.run_folder import RunFolder

COMMON = {
    "name": "tiny",
    "tasks": [{"family": "random", "worlds": 2}],
    "observation": {"terms": ["situation", "crowd"]},
    "checkpoints": 3,
    "decisions": 600,
    "validation": {"scenarios": 1, "every": 3},
}
SMALL = {"steps": 20, "minibatch": 100, "epochs": 2, "hidden": [8]}
KINDS = {
    "ppo": {"ppo": SMALL},
    "team": {"ppo": SMALL | {"critic": "team"}},
    "both": {"ppo": SMALL | {"critic": "team", "action": "both", "reach": 0.125, "patience": 4.0}},
    "beside": {"ppo": SMALL | {"action": "both", "reach": 0.125, "patience": 4.0}},
    "velocity": {"ppo": SMALL | {"hidden": [], "critic": "team", "action": "velocity"}},
    "bandit": {
        "bandit": {
            "strategy": {"name": "LinearThompson"},
            "context": ["free_near", "carrying_far", "carrying_near"],
            "credit": {"hold": 5.0, "until": ["carrying_far", "carrying_near"], "horizon": 10.0},
        }
    },
    "missions": {
        "bandit": {
            "strategy": {"name": "LinearThompson", "parameters": {"prior": 0.1}},
            "context": ["free_far", "carrying_far"],
            "comparison": {"group": 2},
            "exported": {"exploration": 0.0},
        },
        "tasks": [{"family": "random", "worlds": 4}],
        "decisions": 8,
    },
    "es": {"es": {"pairs": 1, "opening": 1}, "checkpoints": 2, "decisions": 2},
    "design": {
        "design": {"candidates": 2, "kept": 1, "opening": 1, "race": {"block": 2, "blocks": 1}},
        "checkpoints": 2,
        "decisions": 4,
    },
}


CHOSEN = ("ORCA", "RepulsionGradient")
"""What the chooser of `beside` knows; the library has more."""
SEEN = ("crowd_1m", "carrying_far", "free_far")
"""What it sees; robots see more."""


def written(directory, kind, **changes):
    """Write a training; that of corrections `beside` a chooser with the chooser."""
    path, training = directory / f"{kind}.yaml", COMMON | KINDS[kind] | changes
    if kind == "beside":
        chooser = directory / "chooser"
        exported(chooser, "AvoidCollision", CHOSEN, SEEN, hidden=(5,), seed=2)
        training["ppo"] = {"chooser": str(chooser)} | training["ppo"]
    path.write_text(yaml.safe_dump(training))
    return path


def job(config, directory, *, resume=False, **more):
    """A training of seed 1 in a new directory, or one to go on with."""
    return replace(TrainingJob(config, 1, RunFolder(directory, {"identity": {}}, resume=resume)), **more)
