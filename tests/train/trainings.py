"""Trainings of some seconds."""

import yaml

COMMON = {
    "name": "tiny",
    "tasks": [{"family": "random", "worlds": 2}],
    "observation": {"terms": ["situation", "crowd"]},
    "checkpoints": 3,
    "decisions": 600,
    "validation": {"scenarios": 1, "every": 3},
}
LEARNERS = {
    "ppo": {"ppo": {"steps": 20, "minibatch": 100, "epochs": 2, "hidden": [8]}},
    "bandit": {
        "bandit": {
            "strategy": {"name": "LinearThompson"},
            "context": ["free_near", "carrying_far", "carrying_near"],
            "credit": {"hold": 5.0, "until": ["carrying_far", "carrying_near"], "horizon": 10.0},
        }
    },
}


def written(directory, learner, **changes):
    path = directory / f"{learner}.yaml"
    path.write_text(yaml.safe_dump(COMMON | LEARNERS[learner] | changes))
    return path
