"""Contestants of `benchmarks.peers`, each a process of its own: worlds of five agents that are stepped for a second.

    python -m benchmarks.shared.contestants NAME WORLDS CORE

It runs in the environment of the peer, so that nothing but NumPy is imported before the contestant is known. It prints
the versions of its packages when it is ready, and then world-ticks per CPU second after each line that it is sent.
"""

import json
import os
import sys
from collections.abc import Callable
from importlib.metadata import version
from itertools import cycle
from time import process_time
from typing import Any

import numpy as np

from benchmarks.shared.measuring import seconds_per_call

AGENTS, SEED = 5, 1
DRAWN = 100
"""Steps whose actions are drawn beforehand, and steps of one call of JaxMARL's rollout."""
NO_END = 1_000_000_000  # steps of an episode that goes on
PART = 300.0  # [s] of a mission, after which it begins anew

Contestant = tuple[Callable[[], object], int]
"""What is called, and how many ticks of each world a call is."""


def actions_of(*shape: int, choices: int = 5) -> Any:
    """Return discrete actions for `DRAWN` steps."""
    return np.random.default_rng(SEED).integers(0, choices, (DRAWN, *shape))


def tick(worlds: int) -> Contestant:
    """Return our full stack: robots hold the option of the highest score, as in `benchmarks.tick`."""
    from benchmarks.shared.scenes import best_option, mission_of, worlds_at_start
    from clean_swarm_env.config.starts import random_start, run_seed

    mission = mission_of(AGENTS)
    made, held = worlds_at_start(mission, worlds), np.full(worlds * AGENTS, best_option(mission))
    starts = [(random_start(mission, SEED, world), run_seed(SEED, str(world))) for world in range(worlds)]

    def step() -> None:
        if made.ticks[0] * made.period >= PART:
            for world, start in enumerate(starts):
                made.reset(world, *start)
            made.hold(held)
        made.tick()

    return step, 1


def batch(worlds: int, each_tick: bool = False) -> Contestant:
    """Return what a learner of ours steps, with options drawn at random: a decision period, or a tick."""
    from benchmarks.shared.scenes import mission_of
    from clean_swarm_env.learning.batch import Batch

    changes: dict[str, float] = {"time_limit": PART}
    mission = mission_of(AGENTS)
    if each_tick:
        changes["decision_period"] = 1.0 / mission.world.control_rate
    made = Batch(mission.model_copy(update=changes), worlds)
    made.reset(range(worlds))
    (options,) = made.options.values()
    following = cycle(actions_of(made.rows, choices=len(options)))
    return lambda: made.step(next(following)), round(made.decision_period / made.period)


def jaxmarl(worlds: int) -> Contestant:
    """Return JaxMARL's `simple_spread` in its fastest form: many steps in one compiled call, which keeps all."""
    import jax
    import jaxmarl

    env = jaxmarl.make("MPE_simple_spread_v3", num_agents=AGENTS, num_landmarks=AGENTS)
    actions = dict(zip(env.agents, actions_of(AGENTS, worlds).swapaxes(0, 1), strict=True))

    def one(carried: Any, given: Any) -> Any:
        key, state = carried
        key, own = jax.random.split(key)
        seen, state, rewards, dones, _ = jax.vmap(env.step)(jax.random.split(own, worlds), state, given)
        return (key, state), (seen, rewards, dones)

    rollout = jax.jit(lambda carried: jax.lax.scan(one, carried, actions))
    key = jax.random.key(SEED)
    carried = key, jax.vmap(env.reset)(jax.random.split(key, worlds))[1]

    def step() -> None:
        nonlocal carried
        carried, _ = jax.block_until_ready(rollout(carried))

    return step, DRAWN


def vmas(worlds: int) -> Contestant:
    """Return VMAS's `simple_spread`."""
    import torch
    from vmas import make_env

    torch.set_num_threads(1)
    env = make_env("simple_spread", num_envs=worlds, device="cpu", seed=SEED, n_agents=AGENTS)
    drawn = np.random.default_rng(SEED).uniform(-1.0, 1.0, (DRAWN, AGENTS, worlds, 2))
    following = cycle([list(torch.tensor(one, dtype=torch.float32)) for one in drawn])
    env.reset()
    return lambda: env.step(next(following)), 1


def mpe2(worlds: int) -> Contestant:
    """Return `simple_spread` of mpe2, by PettingZoo's parallel calls."""
    from mpe2 import simple_spread_v3

    assert worlds == 1
    env = simple_spread_v3.parallel_env(N=AGENTS, max_cycles=NO_END)
    env.reset(seed=SEED)
    following = cycle([dict(zip(env.agents, map(int, row), strict=True)) for row in actions_of(AGENTS)])
    return lambda: env.step(next(following)), 1


def pogema(worlds: int) -> Contestant:
    """Return a grid of pogema whose agents get a new target when they have reached theirs."""
    from pogema import GridConfig, pogema_v0

    assert worlds == 1
    env = pogema_v0(GridConfig(num_agents=AGENTS, on_target="restart", max_episode_steps=NO_END, seed=SEED))
    env.reset()
    following = cycle(actions_of(AGENTS).tolist())
    return lambda: env.step(next(following)), 1


CONTESTANTS: dict[str, tuple[Callable[[int], Contestant], tuple[str, ...]]] = {
    "tick": (tick, ()),
    "Batch": (batch, ()),
    "Batch, each tick": (lambda worlds: batch(worlds, each_tick=True), ()),
    "JaxMARL": (jaxmarl, ("jaxmarl", "jax", "jaxlib")),
    "VMAS": (vmas, ("vmas", "torch")),
    "mpe2": (mpe2, ("mpe2",)),
    "pogema": (pogema, ("pogema",)),
}
"""Name -> what makes it, and the packages of others whose versions it tells."""


def main(name: str, worlds: int, core: int) -> None:
    """Prepare a contestant, find how many calls last for a second, and measure them as often as asked."""
    os.sched_setaffinity(0, {core})  # before any library looks how many threads it may start
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # some peers print
    make, packages = CONTESTANTS[name]
    step, ticks = make(worlds)
    step()  # compiles
    calls, begin = 0, process_time()
    while process_time() - begin < 1.0:
        step()
        calls += 1
    print(json.dumps({package: version(package) for package in packages}), file=answers, flush=True)
    for _ in sys.stdin:
        print(worlds * ticks / seconds_per_call(step, calls), file=answers, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
