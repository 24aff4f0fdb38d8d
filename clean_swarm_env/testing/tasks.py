"""The contract of tasks."""

from __future__ import annotations

import copy
from contextlib import redirect_stdout
from io import StringIO
from typing import Any

import numpy as np
from pettingzoo.test import parallel_api_test, parallel_seed_test

from clean_swarm_env.clean_swarm_v0 import parallel_env
from clean_swarm_env.config.tasks import TASKS
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.testing.expecting import expect, expect_registered, expect_same
from clean_swarm_env.world.task import Task
from selforg.plugins import contract

PERIODS, SEEDS = 6, [3, 4]  # missions of 4 s end, and others begin


def check_task(cls: type[Task[Any, Any]], **settings: Any) -> None:  # noqa: ANN401  (keys of `task:`)
    """Raise PluginError, one line, unless a registered task keeps its contract.

    PettingZoo's tests pass with all kinds of actions; observations and the global state lie in their spaces, measures
    are finite; a world has the same bits alone, among others, led by the baseline, and from a saved state or a copy.
    """
    expect_registered(cls, TASKS)
    mission = {"task": {"name": cls.name, **settings}, "time_limit": 4.0}
    for mode in ("option", "velocity", "both"):
        with contract(cls, ""), redirect_stdout(StringIO()):  # PettingZoo says that a test has passed
            env = parallel_env(mission, action={"mode": mode})
            parallel_api_test(env, num_cycles=10)
            parallel_seed_test(lambda mode=mode: parallel_env(mission, action={"mode": mode}), num_cycles=3)
            observations, _ = env.reset(seed=2)
        names = [*env.observation_names]
        expect(len({*names}) == len(names), cls, "observe", f"names that differ, got {names}")
        while env.agents:
            inside = [env.observation_space(agent).contains(observations[agent]) for agent in env.agents]
            expect(all(inside) and env.state_space.contains(env.state()), cls, "observe", "components in their spaces")
            with contract(cls, ""):
                observations, *_ = env.step({agent: env.action_space(agent).sample() for agent in env.agents})
    for led in (False, True):
        batch, seen = _lived(cls, mission, SEEDS, led)
        halves = [one.reshape(len(SEEDS), -1) for one in seen]
        for world, seed in enumerate(SEEDS):
            alone = [one.ravel() for one in _lived(cls, mission, [seed], led)[1]]
            expect_same(alone, [half[world] for half in halves], cls, "", "a world to have the same bits alone")
    with contract(cls, ""):
        state, twin = batch.get_state(), copy.deepcopy(batch)
    later = _steps(cls, batch)
    expect_same(_steps(cls, twin), later, cls, "State", "a copy to go on with the same bits")
    batch.set_state(state)
    expect_same(_steps(cls, batch), later, cls, "State", "a saved state to go on with the same bits")


def _lived(cls: type, mission: Any, seeds: list[int], led: bool) -> tuple[Batch, list[Any]]:  # noqa: ANN401
    with contract(cls, ""):
        batch = Batch(mission, len(seeds))
        batch.worlds.follow_baseline(led)
        batch.reset(seeds)
    return batch, _steps(cls, batch)


def _steps(cls: type, batch: Batch) -> list[Any]:
    """Return observations, rewards, positions and measures after each decision period with the experts' options."""
    seen: list[Any] = []
    for _ in range(PERIODS):
        with contract(cls, ""):
            step = batch.step(np.tile(batch.choices.default, (batch.rows, 1)))
            task, network = batch.worlds.task, batch.worlds.network
            task.target(0, dict(zip(network.model.sensor_index, network.readings[0].tolist(), strict=True)))
            task.shown(), task.drawn(), task.headline(0)
            measures = list(task.result().values())
        seen += [step.observations.copy(), step.rewards.copy(), batch.worlds.physics.positions.copy(), *measures]
    return seen
