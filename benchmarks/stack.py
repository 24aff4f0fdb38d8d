"""The whole stack: simulated seconds for each CPU second, beside pymunk alone on the same world in the same run.

    python -m benchmarks.stack

One process, CPU time; the contestants take turns, and the median of the repeats counts. Exit code 1 if one world of
five solid robots does less than REQUIRED simulated seconds for a CPU second over whole missions. The figures go to
`results.json`.
"""

import sys
from collections.abc import Callable
from statistics import median
from time import perf_counter, process_time

from benchmarks.floor import floor_seconds_per_tick
from benchmarks.record import record
from clean_swarm_env.config import MissionConfig
from clean_swarm_env.config_files import load_mission
from clean_swarm_env.mission import run_mission
from clean_swarm_env.robot_model import GOAL
from clean_swarm_env.starts import random_start, run_seed
from clean_swarm_env.worlds import Worlds
from selector.coordinator_model import CoordinatorModel
from selector.knowledge import load_knowledge
from selector.library import Library

REQUIRED = 400.0  # simulated seconds for a CPU second
REPEATS = 7
OPTIONS = ("RepulsionFernandez", "RepulsionGradient")
SCENARIOS = 2
SEED = 1
BATCH = 64  # worlds
PARTS = {
    "sense": ("worlds", "_sense"),
    "decide": ("network", "step"),
    "act": ("worlds", "_act"),
    "move": ("worlds", "_move"),
}
"""Part of a tick -> the method that does it."""
EARLY, LATE, WINDOW = 100.0, 3000.0, 100.0  # [s]


def missions_of(mission: MissionConfig, option: str) -> float:
    """Run whole missions with one option; return simulated seconds for each CPU second."""
    simulated, begin = 0.0, process_time()
    for scenario in range(SCENARIOS):
        scores = {GOAL: {name: float(name == option) for name in OPTIONS}}
        result = run_mission(mission, random_start(mission, SEED, scenario), run_seed(SEED, str(scenario)), scores)
        simulated += result.ticks / mission.world.control_rate
    return simulated / (process_time() - begin)


def floor_of(mission: MissionConfig) -> float:
    """Return simulated seconds for each CPU second of pymunk alone, with as many robots on the same torus."""
    ticks = 2000
    return (
        1.0 / mission.world.control_rate / floor_seconds_per_tick(1, mission.robots.count, mission.world.width, ticks)
    )


def worlds_at_start(mission: MissionConfig, worlds: int) -> Worlds:
    """Return worlds at random starts, robots holding the option of the highest score."""
    made = Worlds(mission, CoordinatorModel(GOAL, load_knowledge(mission.knowledge), Library()), worlds)
    for world in range(worlds):
        made.reset(world, random_start(mission, SEED, world), world)
    return made


def batch_of(mission: MissionConfig, worlds: int, ticks: int = 100) -> float:
    """Return simulated seconds of all worlds together for each CPU second, from 20 s on."""
    batch = worlds_at_start(mission, worlds)
    for _ in range(100):
        batch.tick()
    begin = process_time()
    for _ in range(ticks):
        batch.tick()
    return worlds * ticks * batch.period / (process_time() - begin)


def parts_of_a_tick(mission: MissionConfig) -> dict[str, float]:
    """Return microseconds that each part of a tick takes, wall time over the first 100 s of a mission."""
    worlds, ticks = worlds_at_start(mission, 1), 500
    seconds = dict.fromkeys(PARTS, 0.0)

    def timed(part: str, call: Callable[[], None]) -> Callable[[], None]:
        def call_and_note() -> None:
            begin = perf_counter()
            call()
            seconds[part] += perf_counter() - begin

        return call_and_note

    for part, (owner, method) in PARTS.items():
        host = worlds if owner == "worlds" else getattr(worlds, owner)
        setattr(host, method, timed(part, getattr(host, method)))
    for _ in range(ticks):
        worlds.tick()
    return {part: 1e6 * time / ticks for part, time in seconds.items()}


def early_and_late(mission: MissionConfig) -> dict[str, float]:
    """Return microseconds of a tick and pheromones stored, early and late, where all robots patrol: without garbage."""
    nothing = mission.garbage.model_copy(update={"count": 0})
    worlds = worlds_at_start(mission.model_copy(update={"garbage": nothing}), 1)
    figures: dict[str, float] = {}
    for name, moment in (("early", EARLY), ("late", LATE)):
        while worlds.ticks[0] * worlds.period < moment:
            worlds.tick()
        ticks, begin = round(WINDOW / worlds.period), process_time()
        for _ in range(ticks):
            worlds.tick()
        figures[f"{name} tick [us]"] = 1e6 * (process_time() - begin) / ticks
        figures[f"{name} pheromones"] = worlds.pheromones.count(0, "pheromone")
    return figures


def alternating(contestants: dict[str, Callable[[], float]]) -> dict[str, float]:
    """Return the median figure of each contestant; they take turns, after one round that loads compiled code."""
    rounds = [{name: contestant() for name, contestant in contestants.items()} for _ in range(REPEATS + 1)][1:]
    return {name: median(figures[name] for figures in rounds) for name in contestants}


def main() -> int:
    """Print and record the figures."""
    mission = load_mission("table1")
    rates = alternating(
        {
            **{f"missions, {option}": lambda option=option: missions_of(mission, option) for option in OPTIONS},
            "pymunk alone": lambda: floor_of(mission),
            f"{BATCH} worlds": lambda: batch_of(mission, BATCH),
        }
    )
    parts, ages = parts_of_a_tick(mission), early_and_late(mission)
    slowest = min(rates[f"missions, {option}"] for option in OPTIONS)
    print(f"simulated seconds for a CPU second, 5 solid robots, median of {REPEATS} alternating repeats")
    for name, rate in rates.items():
        print(f"  {name:34}{rate:10.0f}{rates['pymunk alone'] / rate:10.2f} x the time of pymunk alone")
    print(f"  required of whole missions        {REQUIRED:10.0f}  {'reached' if slowest >= REQUIRED else 'MISSED'}")
    total = sum(parts.values())
    shares = ", ".join(f"{name} {time:.0f} ({time / total:.0%})" for name, time in parts.items())
    print(f"parts of a tick of one world [us]: {shares}")
    print("patrol alone: " + ", ".join(f"{name} {figure:.0f}" for name, figure in ages.items()))
    record("stack", {"simulated seconds per CPU second": rates, "parts of a tick [us]": parts, "patrol alone": ages})
    return 0 if slowest >= REQUIRED else 1


if __name__ == "__main__":
    sys.exit(main())
