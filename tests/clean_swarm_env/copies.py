"""Random batches at random moments, and their courses, for tests of copies and states."""

import numpy as np

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from tests.clean_swarm_env.courses import CROWD, mission

FAMILIES = ("crowded", "shifting", "continuous", "unseen")
MISSIONS = {
    "crowd": CROWD,
    "pass through": mission(world={"contacts": "pass_through"}),
    "two goals": mission("cleaning-patrol"),
    "stations": mission("transport"),
    "own contents": mission(delivery={"reach": 4.0, "loss": 0.3, "own_contents": True, "pose_memory": 1.0}),
    "late and noisy": mission(delivery={"delay": 0.6, "loss": 0.2}, robots={"pose_noise": 0.1}),
    "models": mission(
        robots=[
            {"model": "small", "count": 4, "radius": 0.15},
            {"model": "large", "count": 2, "max_speed": 0.5, "carries": 2},
        ],
        world={"width": 4.0, "height": 4.0},
        stations={"recycling": [1.0, 1.0], "dump": [3.0, 3.0]},
        garbage={"count": 2},
    ),
    "rooms": mission("three-rooms"),
    "many": mission(robots={"count": 45}, world={"width": 12.0, "height": 12.0}),
}


def changing(name: str) -> FamilyConfig:
    """Return a family whose events come soon."""
    family = load_family(name)
    return family.model_copy(update={"mission": family.mission.model_copy(update={"time_limit": 120.0})})


def random_batch(rng: np.random.Generator, worlds: int | None = None, velocity: bool | None = None) -> Batch:
    """Return a batch of a random kind that has just begun."""
    worlds = int(rng.integers(1, 4)) if worlds is None else worlds
    velocity = rng.random() < 0.25 if velocity is None else velocity
    correcting = rng.random() < 0.25
    action = ActionConfig(mode="velocity" if velocity else "both" if correcting else "option")
    kinds = [*MISSIONS, *FAMILIES]
    kind = kinds[int(rng.integers(len(kinds)))]
    if kind in MISSIONS:
        batch = Batch(MISSIONS[kind], worlds, action=action)
    else:
        family = changing(kind)
        batch = Batch(
            worlds=worlds, family=family, size=family.tori[0] if len(family.tori) > 1 else None, action=action
        )
    batch.reset(rng.integers(1 << 30, size=worlds).tolist())
    return batch


def actions_of(batch: Batch, rng: np.random.Generator) -> np.ndarray:
    """Return random actions of all rows."""
    if batch.action.mode == "velocity":
        return rng.uniform(-1.0, 1.0, (batch.rows, 2))
    options = np.stack([rng.integers(len(options), size=batch.rows) for options in batch.options.values()], axis=1)
    return np.hstack([options, rng.uniform(-1.0, 0.0, (batch.rows, 2))]) if batch.action.mode == "both" else options


def advance(batch: Batch, rng: np.random.Generator, steps: int) -> list[bytes]:
    """Take random steps; return observations, rewards and ends of each."""
    seen = []
    for _ in range(steps):
        step = batch.step(actions_of(batch, rng))
        seen += [part.tobytes() for part in step[:4]] + [repr(batch.finished).encode()]
    return seen
