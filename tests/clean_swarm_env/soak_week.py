"""`python -m tests.clean_swarm_env.soak_week [DAYS]`: one mission of seven simulated days, with all that may change.

Every day a robot joins, another one is taken away, one more joins, and one fails and is carried away; garbage keeps
coming; messages get lost, more of them in the daytime. No number may be infinite or none. After the first day the
memory of the process must not grow by more than 2 MB, nor the time of a tick by more than 5 %, measured beside a world
that stays one day old: both suffer alike from other processes. Linux only: /proc tells the memory.
"""

import gc
import resource
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.worlds import Worlds
from selforg.arrays import Floats
from tests.clean_swarm_env.courses import OPTIONS, avoidance, begin
from tests.soaking import report, time_limit

HOUR, DAY = 3600.0, 86_400.0  # [s]
CARRIED_AWAY = 20  # hour of the day
YOUNG_TICKS = 900  # an hour
GROWTH, SLOWER = 2.0, 1.05  # [MB], ratio of times of a tick


def mission_of(days: int) -> MissionConfig:
    """Return the mission: about five robots at work all along, whatever comes and goes."""
    events: list[dict[str, object]] = []
    for day in range(days):
        at, row = DAY * day, 2 * day  # rows are used in the order of joining
        events += [
            {"at": at + 6 * HOUR, "do": "join"},
            {"at": at + 6 * HOUR, "do": "deliver", "loss": 0.5, "reach": 8.0},
            {"at": at + 8 * HOUR, "do": "remove", "robots": [row]},
            {"at": at + 12 * HOUR, "do": "fail", "robots": [row + 1]},
            {"at": at + 14 * HOUR, "do": "join"},
            {"at": at + 16 * HOUR, "do": "land", "items": 5},
            {"at": at + 18 * HOUR, "do": "deliver", "loss": 0.25, "reach": 8.0},
        ]
    changes = {
        "world": {"width": 16.0, "height": 16.0},
        "task": {"garbage": {"respawn": 2.0, "capacity": 80}, "patrol": {"evaporation_period": 5.0}},
        "delivery": {"loss": 0.25, "reach": 8.0},
        "time_limit": days * DAY,
        "events": events,
    }
    return MissionConfig.model_validate(with_changes(load_mission("table1").model_dump(), changes))


def made(mission: MissionConfig) -> Worlds:
    """Return worlds for the mission, whose robots avoid each other by Balch's repulsion."""
    worlds = Worlds(mission, avoidance(), 1)
    worlds.hold(np.full(worlds.rows, OPTIONS.index("RepulsionGradient")))
    return worlds


def hours(worlds: Worlds, first: int, count: int) -> Iterator[float]:
    """Run hours from the hour `first` on; yield the CPU time of a tick in each [s]."""
    ticks = round(HOUR / worlds.period)
    for hour in range(first, first + count):
        if hour % 24 == CARRIED_AWAY:
            failed = 2 * (hour // 24) + 1
            worlds.physics.remove(failed)
            worlds.minds.poses.silence([failed])
        yield timed(worlds, ticks)


def timed(worlds: Worlds, ticks: int) -> float:
    """Run some ticks; return the CPU time of each [s]."""
    began = time.process_time()
    for _ in range(ticks):
        worlds.tick()
    return (time.process_time() - began) / ticks


def finite(worlds: Worlds) -> bool:
    """Return whether all numbers of bodies, orders and networks are finite."""
    arrays = (worlds.physics.positions, worlds.physics.headings, worlds.minds.commands.vectors)
    arrays += (worlds.network.state.values, worlds.network.readings, worlds.minds.poses.own)
    return all(bool(np.isfinite(array).all()) for array in arrays)


def resident() -> float:
    """Return the memory that the process has now [MB]."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * resource.getpagesize() / 1e6


def soak(days: int) -> list[str]:
    """Run as many of the days as the limit of time allows; return what went wrong."""
    wrong: list[str] = []
    mission, began = mission_of(days), time.monotonic()
    worlds, young = made(mission), made(mission)
    begin(worlds, 0, 7)
    memory, times, young_times = np.zeros((3, days, 24))
    done, after_one_day = 0, b""
    while done < days and time.monotonic() - began < time_limit():
        for hour, took in enumerate(hours(worlds, 24 * done, 24)):
            if done:
                young.set_state(after_one_day)
            memory[done, hour], times[done, hour], young_times[done, hour] = resident(), took, timed(young, YOUNG_TICKS)
            if not finite(worlds):
                wrong.append(f"a number is not finite after {24 * done + hour + 1} h")
        tick, megabytes, dumped = 1e6 * np.median(times[done]), memory[done].mean(), worlds.task.garbage.done[0]
        done += 1
        print(f"day {done}: {tick:.1f} us of CPU time a tick, {megabytes:.2f} MB, {dumped} items dumped")
        after_one_day = after_one_day or worlds.get_state()
    if done > 2:
        wrong += judged(memory[1:done], (times / young_times)[1:done])
    report(24 * done, 0 if wrong else 24 * done)
    return wrong


def judged(memory: Floats, times: Floats) -> list[str]:
    """Return what is wrong with memory [MB] and times of a tick beside a young world's, both (days, hours)."""
    half = len(times) // 2
    grown = float(memory[-1].mean() - memory[0].mean())
    slower = float(np.median(times[-half:]) / np.median(times[:half]))
    print(f"memory {grown:+.2f} MB; a tick takes {slower:.3f} times as long in the second half as in the first")
    wrong = [f"memory grew by {grown:.2f} MB"] if grown > GROWTH else []
    return wrong + ([f"a tick became {slower:.3f} times as long"] if slower > SLOWER else [])


def main(arguments: list[str]) -> int:
    """Run the soak; return 1 where something went wrong."""
    wrong = soak(int(arguments[0]) if arguments else 7)
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
