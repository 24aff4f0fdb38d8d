"""The fixed costs of worlds: memory of the first and of each further one, and the time of a start.

    python -m benchmarks.costs

Every figure is taken in a process of its own. `first start` compiles into an empty cache, `second start` loads that
cache. Both end after the first second of a mission.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable

from benchmarks.shared.measuring import middle
from benchmarks.shared.record import record

STARTS = 5
MORE = 256  # worlds
MANY = 10_000  # robots in one world

START = """
from time import perf_counter, process_time
begin = perf_counter()
from benchmarks.shared.scenes import mission_of, worlds_at_start
worlds = worlds_at_start(mission_of(5), 1)
for _ in range(5):
    worlds.tick()
import json
print(json.dumps({"cpu": process_time(), "wall": perf_counter() - begin}))
"""
MEMORY = """
import json, resource
from benchmarks.shared.scenes import mission_of, worlds_at_start
worlds = worlds_at_start(mission_of(ROBOTS), WORLDS)
for _ in range(100):
    worlds.tick()
now = next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmRSS")) / 1024.0
print(json.dumps({"now": now, "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0}))
"""


def figures_of(program: str, **environment: str) -> dict[str, float]:
    """Return the figures that a Python program prints."""
    done = subprocess.run(
        [sys.executable, "-c", program], env={**os.environ, **environment}, check=True, capture_output=True, text=True
    )
    figures: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return figures


def starts() -> dict[str, float]:
    """Return CPU seconds of the first start and of later ones."""
    with tempfile.TemporaryDirectory() as cache:
        first = figures_of(START, NUMBA_CACHE_DIR=cache)
        later = [figures_of(START, NUMBA_CACHE_DIR=cache) for _ in range(STARTS)]
    second: Callable[[str], float] = lambda clock: middle([figures[clock] for figures in later])  # noqa: E731
    return {
        "first start, CPU [s]": first["cpu"],
        "first start, wall [s]": first["wall"],
        "second start, CPU [s]": second("cpu"),
        "second start, wall [s]": second("wall"),
    }


def memory() -> dict[str, float]:
    """Return megabytes of a process with one world, and of each further world."""
    sizes = ((5, 1), (5, 1 + MORE), (MANY, 1))
    programs = (MEMORY.replace("ROBOTS", str(robots)).replace("WORLDS", str(worlds)) for robots, worlds in sizes)
    one, many, large = map(figures_of, programs)
    return {
        "first world [MB]": one["now"],
        "peak of the first world [MB]": one["peak"],
        "each further world [MB]": (many["now"] - one["now"]) / MORE,
        "a robot among 10,000 [kB]": 1000.0 * (large["peak"] - one["now"]) / MANY,
    }


def main() -> None:
    """Print and record the figures."""
    figures = {"memory": memory(), "start": starts()}
    for told in figures.values():
        for name, figure in told.items():
            print(f"{name:32}{figure:10.2f}")
    record("costs", figures)


if __name__ == "__main__":
    main()
