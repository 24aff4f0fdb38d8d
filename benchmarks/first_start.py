"""The very first start: compiling into an empty cache on one core and on all, CPU and wall time.

    python -m benchmarks.first_start [STARTS]   # on an idle machine
    python -m benchmarks.first_start --list     # writes the list of kernels by which processes share the work

The list is `clean_swarm_env/learning/first_kernels.txt`; it is made again when a test says that kernels have changed.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator

from numba import types

from benchmarks.shared.record import record
from clean_swarm_env.learning.warm_up import FIRST_KERNELS, usable_cpus
from selforg.compiler.ahead import ARRAY, NUMBER_TYPES
from selforg.compiler.decorators import KERNELS

STARTS = 3
START = "from clean_swarm_env import Batch; Batch()"
TIMED = """
import json, sys, time
from numba.core import event
import clean_swarm_env.learning.batch as batch
from clean_swarm_env.learning import warm_up
from benchmarks.first_start import compiled_lines
from selforg.compiler.decorators import KERNELS

seconds, begun = {}, []


class Clock(event.Listener):
    def on_start(self, event):
        begun.append(time.process_time())

    def on_end(self, event):
        took = time.process_time() - begun.pop()
        function = event.data["dispatcher"].py_func
        name = f"{function.__module__}.{function.__qualname__}"
        seconds[name] = seconds.get(name, 0.0) + took


event.register("numba:compile", Clock())
warm_up.FIRST_KERNELS = warm_up.Path("/dev/null")
batch.Batch()


def order(line):
    name = line.split()[0]
    return name == warm_up.EVERY_MISSION, -seconds.get(name, 0.0)


lines = sorted(compiled_lines(), key=order)
print("\\n".join(lines))
"""


def compiled_lines() -> Iterator[str]:
    """Yield a line for each kernel of this process and for each set of types that it has been compiled for."""
    for name, kernel in KERNELS.items():
        for given in kernel.overloads:
            texts = [
                f"{one.dtype}[{one.ndim}{one.layout}]" if isinstance(one, types.Array) else str(one) for one in given
            ]
            if all(text in NUMBER_TYPES or ARRAY.fullmatch(text) for text in texts):
                yield " ".join((name, *texts))


def start(cores: int) -> tuple[float, float]:
    """Return CPU seconds of all processes and wall seconds of a first start on some cores."""
    with tempfile.TemporaryDirectory() as cache:
        before, began = os.times(), time.perf_counter()
        pinned = f"import os; os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:{cores}])\n"
        subprocess.run([sys.executable, "-c", pinned + START], env={**os.environ, "NUMBA_CACHE_DIR": cache}, check=True)
        wall, after = time.perf_counter() - began, os.times()
    return sum(after[2:4]) - sum(before[2:4]), wall


def main(arguments: list[str]) -> None:
    """Print and record the figures, or write the list."""
    if arguments == ["--list"]:
        with tempfile.TemporaryDirectory() as cache:
            environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
            lines = subprocess.run([sys.executable, "-c", TIMED], env=environment, check=True, capture_output=True)
        FIRST_KERNELS.write_bytes(lines.stdout)
        return
    figures: dict[str, dict[str, float]] = {}
    for cores in sorted({1, usable_cpus()}):
        told = [start(cores) for _ in range(int(arguments[0]) if arguments else STARTS)]
        figures[f"{cores} cores"] = {
            f"{name}, {clock} [s]": pick(column)
            for clock, column in zip(("CPU", "wall"), zip(*told, strict=True), strict=True)
            for name, pick in (("min", min), ("median", lambda times: sorted(times)[len(times) // 2]), ("max", max))
        }
        print(
            f"{cores} cores",
            *(f"{name} {figure:.1f}" for name, figure in figures[f"{cores} cores"].items()),
            sep="\n  ",
        )
    record("first start", figures)


if __name__ == "__main__":
    main(sys.argv[1:])
