"""Trainings of some seconds: `missions` is one by bandit, rewarded by the costs of whole missions."""

from dataclasses import replace

import yaml

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
    "both": {"ppo": SMALL | {"critic": "team", "action": "both"}},
    "velocity": {"ppo": SMALL | {"hidden": [], "critic": "team", "action": "velocity"}},
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


def written(directory, kind, **changes):
    """Write a training."""
    path = directory / f"{kind}.yaml"
    path.write_text(yaml.safe_dump(COMMON | KINDS[kind] | changes))
    return path


def job(config, directory, *, resume=False, **more):
    """A training of seed 1 in a new directory, or one to go on with."""
    return replace(TrainingJob(config, 1, RunFolder(directory, {"identity": {}}, resume=resume)), **more)
