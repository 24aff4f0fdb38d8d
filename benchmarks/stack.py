"""Whole missions of the full stack: simulated seconds for each CPU second, beside pymunk alone in the same run.

    python -m benchmarks.stack

One process, CPU time; the contestants take turns, and the median of the repeats counts. Exit code 1 if one world of
five solid robots does less than REQUIRED simulated seconds for a CPU second over whole missions. The figures go to
`results.json`. `benchmarks.tick` measures ticks by size and by part.
"""

import sys

from benchmarks.floor import floor_seconds_per_tick
from benchmarks.shared.measuring import REPEATS, by_turns, middle, seconds_per_call
from benchmarks.shared.record import record
from benchmarks.shared.scenes import SEED, mission_holding, mission_of, worlds_at_start
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start, run_seed
from clean_swarm_env.learning.batch import run_out

REQUIRED = 800.0  # simulated seconds for a CPU second
OPTIONS = ("RepulsionFernandez-view2.0", "RepulsionGradient-view1.5")
SCENARIOS = 2
BATCH = 64  # worlds
WARM_UP, TICKS = 100, 100


def missions_of(mission: MissionConfig, option: str) -> float:
    """Run whole missions with one option; return CPU seconds for each simulated second."""
    ticks = 0

    def run() -> None:
        nonlocal ticks
        for scenario in range(SCENARIOS):
            start = random_start(mission, SEED, scenario)
            ticks += run_out(mission_holding(option, mission, start, run_seed(SEED, str(scenario)))).ticks

    seconds = seconds_per_call(run, 1)
    return seconds * mission.world.control_rate / ticks


def floor_of(mission: MissionConfig) -> float:
    """Return CPU seconds for each simulated second of pymunk alone, with as many robots on the same torus."""
    tick = floor_seconds_per_tick(1, mission.robots.count, mission.world.width, 2000)
    return tick * mission.world.control_rate


def batch_of(mission: MissionConfig, worlds: int) -> float:
    """Return CPU seconds for each simulated second of all worlds together, from 20 s on."""
    batch = worlds_at_start(mission, worlds)
    for _ in range(WARM_UP):
        batch.tick()
    return seconds_per_call(batch.tick, TICKS) * mission.world.control_rate / worlds


def main() -> int:
    """Print and record the figures."""
    mission = mission_of(5)
    told = by_turns(
        {
            **{f"missions, {option}": lambda option=option: missions_of(mission, option) for option in OPTIONS},
            "pymunk alone": lambda: floor_of(mission),
            f"{BATCH} worlds": lambda: batch_of(mission, BATCH),
        }
    )
    rates = {name: 1.0 / middle(costs) for name, costs in told.items()}
    slowest = min(rates[f"missions, {option}"] for option in OPTIONS)
    print(f"simulated seconds for a CPU second, 5 solid robots, median of {REPEATS} repeats by turns")
    for name, rate in rates.items():
        print(f"  {name:34}{rate:10.0f}{rates['pymunk alone'] / rate:10.2f} x the time of pymunk alone")
    print(f"  required of whole missions        {REQUIRED:10.0f}  {'reached' if slowest >= REQUIRED else 'MISSED'}")
    record("stack", {"simulated seconds per CPU second": rates})
    return 0 if slowest >= REQUIRED else 1


if __name__ == "__main__":
    sys.exit(main())
