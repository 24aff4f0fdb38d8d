"""`python -m tests.selector.coordination.soak_switching [SECONDS]`: swarms that switch at random stay as they are.

Two batches of worlds of equal seeds draw every option of every coordinator anew in each decision period, by default for
an hour of simulated time. They must have equal fingerprints all along, and the memory of the process must not grow
once there are as many pheromones and remembered plans as a mission needs (Linux: /proc tells the memory).
"""

import hashlib
import sys

import numpy as np

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.world.task import coordinators_of
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import library_of
from selector.knowledge import load_knowledge
from tests.soaking import report, resident, rounds

HOUR = 3600.0  # [s]
LOOKS = 120  # at fingerprints and memory
GROWTH = 256 * 1024  # [bytes] from the third quarter to the last; a leak of 300 bytes in each period would be more
PARTS = ("positions", "headings")


def mission_of() -> MissionConfig:
    """Return the mission with two coordinators, without garbage: it has no end."""
    return MissionConfig.model_validate(
        with_changes(load_mission("cleaning-patrol").model_dump(), {"task": {"garbage": {"count": 0}}})
    )


class Switching:
    """Worlds that switch at random."""

    def __init__(self, mission: MissionConfig, seed: int, worlds: int = 2) -> None:
        models = coordinators_of(mission, load_knowledge(mission.knowledge), library_of())
        self.worlds = Worlds(mission, models, worlds)
        for world in range(worlds):
            self.worlds.reset(world, random_start(mission, seed, world), seed + world)
        self.options = [len(model.options) for model in models]
        self.rng = np.random.default_rng(seed)
        self.ticks = round(mission.decision_period * mission.world.control_rate)

    def period(self) -> None:
        """One decision period."""
        drawn = [self.rng.integers(count, size=self.worlds.rows) for count in self.options]
        self.worlds.hold(np.stack(drawn, axis=1))
        for _ in range(self.ticks):
            self.worlds.tick()

    def fingerprint(self) -> str:
        """Return a hash of where all robots are and what their networks and their contents know."""
        worlds, digest = self.worlds, hashlib.sha256()
        arrays = [getattr(worlds.physics, part) for part in PARTS] + [worlds.network.state.values]
        arrays += [content.network.state.values for c in worlds.coordinators for content in c.contents]
        for array in arrays:
            digest.update(np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()


def soak(seconds: float) -> list[str]:
    """Return what went wrong."""
    mission = mission_of()
    one, other = Switching(mission, 11), Switching(mission, 11)
    periods = round(seconds / mission.decision_period)
    looks = max(periods // LOOKS, 1)
    memory = []
    done = 0
    for period in rounds(periods):
        one.period()
        other.period()
        if (period + 1) % looks == 0:
            memory.append(resident())
            if one.fingerprint() != other.fingerprint():
                report(period + 1, period)
                return [f"fingerprints of equal seeds differ after {period * mission.decision_period:g} s"]
        done = period + 1
    third, last = (float(np.mean(part)) for part in np.array_split(memory, 4)[2:])
    stored = one.worlds.minds.buffers["pheromones"].count(0, "pheromone")
    print(f"{done} decision periods of 2 x {one.worlds.rows} robots, fingerprint {one.fingerprint()[:12]}")
    print(f"memory: third quarter {third / 1024:.0f} KiB, last {last / 1024:.0f} KiB; {stored} pheromones in a world")
    if last - third > GROWTH:
        report(done, 0)
        return [f"memory grew by {(last - third) / 1024:.0f} KiB from the third quarter to the last"]
    report(done, done)
    return []


def main(arguments: list[str]) -> int:
    wrong = soak(float(arguments[0]) if arguments else HOUR)
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
