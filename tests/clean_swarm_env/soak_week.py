"""`python -m tests.clean_swarm_env.soak_week [DAYS]`: one mission of seven simulated days, with all that may change.

Every day a robot joins, another one is taken away, one more joins, and one fails and is carried away; garbage keeps
coming; messages get lost, more of them in the daytime. No number may be infinite or none. After the first day the
memory of the process must not grow by more than 2 MB. Linux only: /proc tells the memory.
"""

import sys
import time
from collections.abc import Iterator

import numpy as np

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.worlds import Worlds
from tests.clean_swarm_env.courses import OPTIONS, avoidance, begin
from tests.soaking import report, resident, time_limit

HOUR, DAY = 3600.0, 86_400.0  # [s]
CARRIED_AWAY = 20  # hour of the day
GROWTH = 2.0  # [MB]


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
    worlds.hold(np.full(worlds.rows, OPTIONS.index("RepulsionGradient-view1.5")))
    return worlds


def hours(worlds: Worlds, first: int, count: int) -> Iterator[int]:
    """Run hours from the hour `first` on; yield each when it is over."""
    for hour in range(first, first + count):
        if hour % 24 == CARRIED_AWAY:
            failed = 2 * (hour // 24) + 1
            worlds.physics.remove(failed)
            worlds.minds.poses.silence([failed])
        for _ in range(round(HOUR / worlds.period)):
            worlds.tick()
        yield hour


def finite(worlds: Worlds) -> bool:
    """Return whether all numbers of bodies, orders and networks are finite."""
    arrays = (worlds.physics.positions, worlds.physics.headings, worlds.minds.commands.vectors)
    arrays += (worlds.network.state.values, worlds.network.readings, worlds.minds.poses.own)
    return all(bool(np.isfinite(array).all()) for array in arrays)


def soak(days: int) -> list[str]:
    """Run as many of the days as the limit of time allows; return what went wrong."""
    wrong: list[str] = []
    worlds, began = made(mission_of(days)), time.monotonic()
    begin(worlds, 0, 7)
    memory, done = np.zeros((days, 24)), 0
    while done < days and time.monotonic() - began < time_limit():
        for hour in hours(worlds, 24 * done, 24):
            memory[done, hour % 24] = resident() / 1e6
            if not finite(worlds):
                wrong.append(f"a number is not finite after {hour + 1} h")
        print(f"day {done + 1}: {memory[done].mean():.2f} MB, {worlds.task.garbage.done[0]} items dumped")
        done += 1
    if done > 2 and memory[done - 1].mean() - memory[1].mean() > GROWTH:
        wrong.append(f"memory grew from {memory[1].mean():.2f} to {memory[done - 1].mean():.2f} MB")
    report(24 * done, 0 if wrong else 24 * done)
    return wrong


def main(arguments: list[str]) -> int:
    """Run the soak; return 1 where something went wrong."""
    wrong = soak(int(arguments[0]) if arguments else 7)
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
