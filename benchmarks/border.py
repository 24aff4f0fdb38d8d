"""The cost of PettingZoo beyond the tick, and steps a second beside mpe2's `simple_spread` with as many agents.

    python -m benchmarks.border

One process, CPU time, by turns. A decision a tick (decision period 0.2 s). mpe2 comes with the extra `bench`; without
that extra the line of mpe2 is left out.
"""

from collections.abc import Callable
from importlib.util import find_spec
from itertools import cycle
from typing import Any

import numpy as np

from benchmarks.shared.measuring import Figure, by_turns, ratio, seconds_per_call
from benchmarks.shared.record import record
from benchmarks.shared.scenes import SEED, mission_of, worlds_at_start
from clean_swarm_env.clean_swarm_v0 import parallel_env
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import AVOIDANCE

STEPS = 500
AGENTS = 5
ENDLESS = 1e6  # [s]
NO_END = 25_000_000  # steps of a simple_spread that goes on


def decision_a_tick(robots: int) -> MissionConfig:
    """Return the default mission with a decision each tick and no end."""
    mission = mission_of(robots)
    return mission.model_copy(update={"decision_period": 1.0 / mission.world.control_rate, "time_limit": ENDLESS})


def stepping(env: Any, choices: int) -> Callable[[], float]:
    """Return a contestant that gives the CPU seconds of a step with actions drawn beforehand."""
    env.reset(seed=SEED)
    drawn = np.random.default_rng(SEED).integers(0, choices, (STEPS, len(env.agents)))
    actions = [dict(zip(env.agents, map(int, row), strict=True)) for row in drawn]
    following = cycle(actions)

    def step() -> None:
        if not env.agents:
            env.reset()
        env.step(next(following))

    return lambda: seconds_per_call(step, STEPS)


def ticking(robots: int) -> Callable[[], float]:
    """Return a contestant that gives the CPU seconds of a tick, with options that change as in `stepping`."""
    worlds = worlds_at_start(decision_a_tick(robots), 1)
    options = len(worlds.minds.coordinator_of(AVOIDANCE).model.options)
    drawn = np.random.default_rng(SEED).integers(0, options, (STEPS, worlds.rows))
    following = cycle(drawn)

    def tick() -> None:
        worlds.hold(next(following))
        worlds.tick()

    return lambda: seconds_per_call(tick, STEPS)


def main() -> None:
    """Print and record the figures."""
    env = parallel_env(decision_a_tick(AGENTS))
    contestants = {"step": stepping(env, int(env.action_space(env.possible_agents[0]).n)), "tick": ticking(AGENTS)}
    if find_spec("mpe2"):
        from mpe2 import simple_spread_v3

        spread = simple_spread_v3.parallel_env(N=AGENTS, max_cycles=NO_END)
        contestants["simple_spread"] = stepping(spread, 5)
    told = by_turns(contestants)
    step, tick = Figure.of(told["step"]), Figure.of(told["tick"])
    beyond = Figure.of([1e6 * (one - other) for one, other in zip(told["step"], told["tick"], strict=True)])
    figures = {"step [us]": 1e6 * step.value, "tick [us]": 1e6 * tick.value, "beyond the tick [us]": beyond.value}
    if "simple_spread" in told:
        times = ratio(told["simple_spread"], told["step"])
        figures["simple_spread [us]"] = 1e6 * Figure.of(told["simple_spread"]).value
        figures["times simple_spread"], figures["spread of times simple_spread"] = times.value, times.spread
    for name, figure in figures.items():
        print(f"{name:32}{figure:10.2f}")
    record("border", {f"{AGENTS} agents": figures})


if __name__ == "__main__":
    main()
