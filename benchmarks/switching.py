"""The cost of switching options: robots that draw an option in every decision period, beside robots that keep theirs.

    python -m benchmarks.switching

One process, CPU time. The same worlds switch and keep by turns of TURN decision periods, so that garbage, buffers and
the mix of options are alike in both. In a turn of keeping robots hold the options drawn last. A turn includes what
follows from a switch: new plans, and configurations that begin anew. Exit code 1 if a switch in every decision period
costs LIMIT of the tick or more. The figures go to `results.json`.
"""

import sys
from statistics import median
from time import process_time

import numpy as np

from benchmarks.shared.measuring import by_turns, ratio
from benchmarks.shared.record import record
from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import library_of
from selector.knowledge import load_knowledge
from selforg.arrays import Ints

LIMIT = 0.10  # of the tick
SIZES = (1, 64)  # worlds of five robots
TURN = 10  # decision periods
REPEATS = {1: 101, 64: 25}  # pairs of turns; the median of their ratios counts, as load comes and goes
WARM_UP = 20.0  # [s]
MISSIONS = ("table1", "cleaning-patrol")  # one coordinator, two coordinators


def worlds_of(mission: MissionConfig, worlds: int) -> Worlds:
    """Return worlds that have run for a while, robots holding options at random."""
    models = coordinators_of(mission, load_knowledge(mission.knowledge), library_of())
    made = Worlds(mission, models, worlds)
    for world in range(worlds):
        made.reset(world, random_start(mission, 1, world), world)
    return made


class Swarm:
    """Worlds whose robots switch options at random, or keep them."""

    def __init__(self, mission: MissionConfig, worlds: int) -> None:
        self.worlds = worlds_of(mission, worlds)
        self.options = [len(coordinator.model.options) for coordinator in self.worlds.coordinators]
        self.ticks = round(mission.decision_period * mission.world.control_rate)
        self.rng = np.random.default_rng(3)
        while self.worlds.ticks[0] * self.worlds.period < WARM_UP:
            self.turn(True)

    def draw(self) -> Ints:
        """Return an option (R, C) for every robot and coordinator."""
        return np.stack([self.rng.integers(count, size=self.worlds.rows) for count in self.options], axis=1)

    def turn(self, switching: bool) -> float:
        """Return CPU seconds of a tick, over a turn."""
        drawn = [self.draw() for _ in range(TURN)]  # drawn before the clock starts: a strategy draws, not the switch
        begin = process_time()
        for options in drawn:
            if switching:
                self.worlds.hold(options)
            for _ in range(self.ticks):
                self.worlds.tick()
        return (process_time() - begin) / (TURN * self.ticks)

    def hold_alone(self) -> float:
        """Return CPU seconds of a switch by itself, warm in the caches."""
        drawn = [self.draw() for _ in range(100)]
        begin = process_time()
        for options in drawn:
            self.worlds.hold(options)
        return (process_time() - begin) / len(drawn)


def cost_of(name: str, worlds: int) -> dict[str, float]:
    """Return microseconds of a tick of a world, kept and switched, and the cost of switching by that of the tick."""
    swarm = Swarm(load_mission(name), worlds)
    told = by_turns({"kept": lambda: swarm.turn(False), "switched": lambda: swarm.turn(True)}, REPEATS[worlds])
    return {
        "kept tick [us]": 1e6 * median(told["kept"]) / worlds,
        "switched tick [us]": 1e6 * median(told["switched"]) / worlds,
        "share of the tick": ratio(told["switched"], told["kept"]).value - 1.0,
        "a switch alone, all worlds [us]": 1e6 * swarm.hold_alone(),
    }


def main() -> int:
    """Print and record the figures."""
    figures = {f"{name}, {size} worlds": cost_of(name, size) for name in MISSIONS for size in SIZES}
    print(f"switching options in every decision period (1 s, 5 ticks), limit {LIMIT:.0%} of the tick")
    for name, costs in figures.items():
        reached = "reached" if costs["share of the tick"] < LIMIT else "MISSED"
        print(f"  {name:28}" + ", ".join(f"{what} {value:.3g}" for what, value in costs.items()) + f"  {reached}")
    record("switching", figures)
    return 0 if all(costs["share of the tick"] < LIMIT for costs in figures.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
