"""Random batches at random moments, what takes states and copies at every border, and their courses."""

import copy
import gc
import pickle

import cloudpickle
import gymnasium
import numpy as np

import clean_swarm_env.registration  # noqa: F401  (the ids of the environments)
from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_vector import RobotVectorEnv, TeamVectorEnv
from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import TASKS
from clean_swarm_env.world.worlds import Worlds
from tests.clean_swarm_env.courses import CROWD, begun, mission, ticked, worlds_at_start
from tests.object_graph import arrays_of, differing, pointing_into, shared_in

gc.freeze()  # else each `gc.collect` of a test looks through all that was imported
PICKLED = {
    "pickle": lambda thing: pickle.loads(pickle.dumps(thing)),
    "cloudpickle": lambda thing: pickle.loads(cloudpickle.dumps(thing)),
}
FAMILIES = ("crowded", "shifting", "continuous", "unseen")
OTHER_TASKS = [name for name in TASKS.names() if name != "Cleaning"]
MISSIONS = {
    "crowd": CROWD,
    "pass through": mission(world={"contacts": "pass_through"}),
    "two goals": mission("cleaning-patrol"),
    "stations": mission("transport"),
    "own contents": mission(delivery={"reach": 4.0, "loss": 0.3, "own_contents": True, "pose_memory": 1.0}),
    "late and noisy": mission(
        delivery={"delay": 0.6, "loss": 0.2}, robots={"pose_noise": 0.1, "pose_drift": 0.1, "slip": 0.1}
    ),
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
SHORT = mission(garbage={"count": 2}, time_limit=30.0)


BORDERS = {
    "Worlds": lambda: worlds_at_start(CROWD, [5]),
    "Batch": lambda: begun(Batch(MISSIONS["late and noisy"], 2), [3, 4]),
    "Batch of a family": lambda: begun(Batch(family="shifting", action={"mode": "velocity"}), [3]),
    "Batch of a task": lambda: begun(Batch({"task": "Foraging", "time_limit": 10.0}, 2), [3, 4]),
    "parallel_env": lambda: begun(clean_swarm_v0.parallel_env(MISSIONS["own contents"]), seed=3),
    "parallel_env of a family": lambda: begun(clean_swarm_v0.parallel_env(family="shifting", max_cycles=30), seed=3),
    "parallel_env of a task": lambda: begun(clean_swarm_v0.parallel_env({"task": "MaxValue"}), seed=3),
    "CleanSwarmTeam": lambda: begun(gymnasium.make("CleanSwarm-v0", mission=SHORT).unwrapped, seed=3),
    "one for all": lambda: begun(gymnasium.make("CleanSwarmOneForAll-v0", mission=SHORT).unwrapped, seed=3),
    "TeamVectorEnv": lambda: begun(TeamVectorEnv(2, mission=MISSIONS["pass through"]), seed=3),
    "RobotVectorEnv": lambda: begun(RobotVectorEnv(2, mission=SHORT), seed=3),
}
"""Name -> something that takes states and can be copied; no two have the same mission and kind."""


def changing(name: str) -> FamilyConfig:
    """Return a family whose events come soon."""
    family = load_family(name)
    return family.model_copy(update={"mission": family.mission.model_copy(update={"time_limit": 120.0})})


def random_batch(rng: np.random.Generator) -> Batch:
    """Return a batch of a random kind that has just begun."""
    worlds = int(rng.integers(1, 4))
    action = ActionConfig(mode=("velocity", "both", "option", "option")[int(rng.integers(4))])
    kinds = [*MISSIONS, *FAMILIES, *OTHER_TASKS]
    kind = kinds[int(rng.integers(len(kinds)))]
    if kind in FAMILIES:
        family = changing(kind)
        size = family.tori[0] if len(family.tori) > 1 else None
        batch = Batch(worlds=worlds, family=family, size=size, action=action)
    else:
        batch = Batch(MISSIONS.get(kind) or {"task": kind, "time_limit": 10.0}, worlds, action=action)
    return begun(batch, rng.integers(1 << 30, size=worlds).tolist())


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


def played(made, seed: int, steps: int = 12) -> list[bytes]:
    """Return what anything of `BORDERS` answers to random actions that depend on the seed and the step only."""
    if isinstance(made, Batch):
        return advance(made, np.random.default_rng(seed), steps)
    answers = []
    for number in range(seed, seed + steps):
        if isinstance(made, Worlds):
            answers.append([ticked(made).physics.bodies])
        elif hasattr(made, "possible_agents"):
            if not made.agents:
                made.reset(seed=9)
            actions = {agent: sampled(made.action_space(agent), number + int(agent[6:])) for agent in made.agents}
            answers += [[*part.values()] for part in made.step(actions)[:-1]]
        elif hasattr(made, "num_envs"):
            space, alone = made.action_space, made.action_space.shape == ()  # Stable-Baselines3 has the space of a row
            answers.append(made.step(np.full(made.num_envs, number % 2) if alone else sampled(space, number))[:-1])
        else:
            answers.append(made.step(sampled(made.action_space, number))[:-1])
            if any(answers[-1][2:]):
                made.reset(seed=9)
    return [np.asarray(part).tobytes() for answer in answers for part in answer]


def sampled(space, seed: int):
    """Return what a space samples after a seed."""
    space.seed(seed)
    return space.sample()


def check_copy(made, pickled, seed: int) -> None:
    """Copy something in two ways: same bits side by side, and alone after the original is gone."""
    twin, orphan = copy.deepcopy(made), pickled(made)
    arrays = arrays_of(made)
    assert pointing_into(arrays_of(twin), arrays) == []
    assert shared_in(arrays_of(twin)) == shared_in(arrays)
    course = played(twin, seed)
    assert played(made, seed) == course
    assert differing(made, twin) == []
    del made, twin, arrays
    gc.collect()
    assert played(orphan, seed) == course
