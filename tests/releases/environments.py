"""What a release froze of its environments: spaces, options, rewards, and how a course begins."""

import hashlib
from typing import Any

import gymnasium
import numpy as np

import clean_swarm_env.registration
from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.clean_swarm_v0 import CleanSwarm
from clean_swarm_env.config.tasks import find_task
from clean_swarm_env.learning.reward import RewardConfig, weights_of
from clean_swarm_env.tasks import Cleaning
from clean_swarm_env.world.parts.measure import key_of
from train.cli.listing import names_of

SEED, STEPS = 1, 20
IDS = (clean_swarm_env.registration.TEAM_ID, clean_swarm_env.registration.ONE_FOR_ALL_ID)
MODES = ("velocity", "both")
GROWING = "at least"
"""Key of names to which later releases may add: those of infos, and of reward terms of weight 0."""


def environments() -> dict[str, Any]:
    """Return what is frozen of the environment of each task, each mission and each id, as plain data."""
    named = {name: (name, {}) for name in (*names_of("tasks", ()), *names_of("missions", ()))}
    modes = {f"table1, {mode}": ("table1", {"action": {"mode": mode}}) for mode in MODES}
    found = {key: frozen(clean_swarm_v0.parallel_env(name, **more)) for key, (name, more) in (named | modes).items()}
    return {
        "reward": {GROWING: sorted(weights_of(Cleaning).model_fields), "weights": weights()},
        **found,
        **{name: frozen_team(name) for name in IDS},
    }


def frozen(env: CleanSwarm) -> dict[str, Any]:
    """Return what is frozen of an environment of PettingZoo."""
    agent = env.possible_agents[0]
    return {
        "agents": len(env.possible_agents),
        "actions": repr(env.action_space(agent)),
        "options": {goal: list(names) for goal, names in env.options.items()},
        "observations": repr(env.observation_space(agent)),
        "components": list(env.observation_names),
        "state": f"{env.state_space}, {digest(*env.state_names)}",
        "measures": measures(env.mission.task.name),
        GROWING: sorted(env.reset(seed=SEED)[1][agent]),
        "course": course(env),
    }


def frozen_team(name: str) -> dict[str, Any]:
    """Return what is frozen of an environment of Gymnasium, by its id."""
    env = gymnasium.make(name)
    seen, infos = env.reset(seed=SEED)
    parts = [seen.tobytes()]
    for step in range(STEPS):
        seen, reward, *ends, _ = env.step(np.full(env.action_space.shape, step % 2, dtype=np.int64))
        parts += [seen.tobytes(), rounded(reward), repr(ends)]
    spaces = {"actions": repr(env.action_space), "observations": repr(env.observation_space)}
    return {**spaces, GROWING: sorted(infos), "course": digest(*parts)}


def weights() -> dict[str, float]:
    """Return the terms of the default reward with their weights."""
    return {name: weight for name, weight in RewardConfig().model_dump().items() if weight}


def measures(task: str) -> dict[str, str]:
    """Return the measures by which a task is paid: key -> unit, direction and target."""
    return {key_of(one.name): f"{one.unit}, {one.better}, {one.target:g}" for one in find_task(task).measures}


def course(env: CleanSwarm, steps: int = STEPS, *, reset: bool = True) -> str:
    """Return the digest of the course of an environment: observations, rewards and ends."""
    parts: list[bytes | str] = []
    if reset:
        parts += map(np.ndarray.tobytes, env.reset(seed=SEED)[0].values())
    for step in range(steps):
        if not env.agents:
            env.reset()
        actions = {agent: action(env.action_space(agent), step, row) for row, agent in enumerate(env.agents)}
        seen, rewards, *ends, _ = env.step(actions)
        parts += [*map(np.ndarray.tobytes, seen.values()), *map(rounded, rewards.values()), repr(ends)]
    return digest(*parts)


def rounded(reward: float) -> str:
    """Return a reward with nine decimals: measures of tasks take sines, means and their like from NumPy.

    The last bits of those differ between machines.
    """
    return repr(round(float(reward), 9) + 0.0)


def action(space: gymnasium.Space[Any], step: int, row: int) -> Any:
    """Return an action that differs from robot to robot, and changes every three steps."""
    if isinstance(space, gymnasium.spaces.Dict):
        return {name: action(part, step, row) for name, part in space.items()}
    if isinstance(space, gymnasium.spaces.Discrete):
        return int((step // 3 + row) % space.n)
    if isinstance(space, gymnasium.spaces.MultiDiscrete):
        return (step // 3 + row + np.arange(len(space.nvec))) % space.nvec
    return np.array([0.5, 0.25 * ((step // 3 + row) % 3 - 1)], dtype=np.float32)


def digest(*parts: bytes | str) -> str:
    """Return the first letters of the SHA-256 of texts and bytes, one after the other."""
    content = b"\n".join(part if isinstance(part, bytes) else part.encode() for part in parts)
    return hashlib.sha256(content).hexdigest()[:16]
