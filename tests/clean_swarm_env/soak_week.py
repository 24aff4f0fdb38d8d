"""`python -m tests.clean_swarm_env.soak_week [DAYS]`: one mission of seven simulated days, with all that may change.

Every day a robot joins, another one is taken away, one fails and one more joins; garbage keeps coming; messages get
lost, on some days more of them. From the second day to the last the memory of the
process must stay within 2 MB and the time of a tick within 5 %, no number may be infinite or none, and the second half
of the days, begun from a saved state in other worlds, must end as the whole did (Linux: /proc tells the memory).
"""

import gc
import hashlib
import resource
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.world.worlds import Worlds
from tests.clean_swarm_env.courses import OPTIONS, avoidance, begin
from tests.soaking import report

HOUR, DAY = 3600.0, 86_400.0  # [s]
GROWTH, SLOWER = 2e6, 1.05  # [bytes], ratio of times of a tick


def mission_of(days: int) -> MissionConfig:
    """Return the mission: five robots at work all along, whatever comes and goes."""
    events, working, following = [], list(range(5)), 5
    for day in range(days):
        first, second = working.pop(0), working.pop(0)
        at = DAY * day
        events += [
            {"at": at + 6 * HOUR, "do": "join"},
            {"at": at + 8 * HOUR, "do": "remove", "robots": [first]},
            {"at": at + 12 * HOUR, "do": "fail", "robots": [second]},
            {"at": at + 14 * HOUR, "do": "join"},
            {"at": at + 16 * HOUR, "do": "land", "items": 5},
            {"at": at + 18 * HOUR, "do": "deliver", "loss": 0.5 if day % 2 else 0.25, "reach": 8.0},
        ]
        working += [following, following + 1]
        following += 2
    changes = {
        "world": {"width": 16.0, "height": 16.0},
        "garbage": {"respawn": 2.0, "capacity": 80},
        "delivery": {"loss": 0.25, "reach": 8.0},
        "patrol": {"evaporation_period": 5.0},
        "time_limit": days * DAY,
        "events": events,
    }
    return MissionConfig.model_validate(with_changes(load_mission("table1").model_dump(), changes))


def made(mission: MissionConfig) -> Worlds:
    """Return worlds for the mission, whose robots avoid each other by Balch's repulsion."""
    worlds = Worlds(mission, avoidance(), 1)
    worlds.hold(np.full(worlds.rows, OPTIONS.index("RepulsionGradient")))
    return worlds


def hours(worlds: Worlds, count: int) -> Iterator[float]:
    """Run hours; yield the CPU time of each [s]."""
    ticks = round(HOUR / worlds.period)
    for _ in range(count):
        began = time.process_time()
        for _ in range(ticks):
            worlds.tick()
        yield time.process_time() - began


def fingerprint(worlds: Worlds) -> str:
    """Return a hash of everything that the further course depends on."""
    state = worlds.state_of(0)
    digest = hashlib.sha256(state.rows + state.world + repr((state.agenda, state.streams)).encode())
    for buffer in state.buffers:
        digest.update(buffer.near.tobytes() + buffer.links.tobytes() + repr(buffer.mail).encode())
    return digest.hexdigest()


def finite(worlds: Worlds) -> bool:
    """Return whether all numbers of bodies, orders and networks are finite."""
    arrays = (worlds.physics.positions, worlds.physics.headings, worlds.minds.commands.vectors)
    arrays += (worlds.network.state.value_table, worlds.network.readings, worlds.minds.poses.own)
    return all(bool(np.isfinite(array).all()) for array in arrays)


def resident() -> int:
    """Return the memory that the process has now [bytes]."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * resource.getpagesize()


def soak(days: int) -> list[str]:
    """Return what went wrong."""
    wrong: list[str] = []
    mission = mission_of(days)
    worlds, state = made(mission), b""
    begin(worlds, 0, 7)
    memory, times = np.zeros((days, 24)), np.zeros((days, 24))
    for hour, took in enumerate(hours(worlds, 24 * days)):
        memory[divmod(hour, 24)], times[divmod(hour, 24)] = resident(), took
        if not finite(worlds):
            wrong.append(f"a number is not finite after {hour + 1} h")
        if hour + 1 == 12 * days:
            state = worlds.get_state()
        if hour % 24 == 23:
            day, ticks = hour // 24, HOUR / worlds.period
            tick, resident_mb = 1e6 * times[day].min() / ticks, memory[day].mean() / 1e6
            done = int(worlds.garbage.done[0])
            print(
                f"day {day + 1}: {tick:.1f} us of CPU time a tick, {resident_mb:.2f} MB, {done} items dumped",
                flush=True,
            )
    whole = fingerprint(worlds)
    if days > 2:
        if abs(memory[-1].mean() - memory[1].mean()) > GROWTH:
            wrong.append(f"memory went from {memory[1].mean() / 1e6:.2f} to {memory[-1].mean() / 1e6:.2f} MB")
        if times[-1].min() > SLOWER * times[1].min():
            wrong.append(f"a tick became {times[-1].min() / times[1].min():.3f} times as long")
    other = made(mission)
    other.set_state(state)
    for _ in hours(other, 24 * days - 12 * days):
        pass
    print(f"fingerprints: {whole[:12]} in one run, {fingerprint(other)[:12]} from the saved state")
    if fingerprint(other) != whole:
        wrong.append("two halves that were joined by a saved state differ from one run")
    report(24 * days, 0 if wrong else 24 * days)
    return wrong


def main(arguments: list[str]) -> int:
    """Run the soak; return 1 where something went wrong."""
    wrong = soak(int(arguments[0]) if arguments else 7)
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
