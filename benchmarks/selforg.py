"""Speed and memory of selforg, beside the original's figures from golden/README.md.

Run with `python -m benchmarks.selforg`. CPU time, best of several repeats; growth by medians of
alternating runs. Exit code 1 if a requirement is missed.
"""

import resource
import sys
import time
from collections.abc import Callable

import numpy as np

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import ChemotaxisBalch, Patrol, RepulsionFernandez, RepulsionGradient
from selforg.space import Torus

# The original on a 2.1 GHz Xeon core, ROS replaced by in-process calls [s]
ORIGINAL = {"query": 133e-3, "fernandez": 69e-3, "store": 4.7e-3}
REQUIRED = {"query": 1000.0, "fernandez": 1000.0, "store": 500.0}
MOST_GROWTH, MOST_MEMORY = 1.5, 200e6

Result = tuple[str, str, bool]


def cpu_seconds(call: Callable[[], object], repeats: int = 7, at_least: float = 0.05) -> float:
    """Return the CPU time of one call [s]: the best of `repeats` runs of at least that length."""
    call()
    number = 1
    while True:
        start = time.process_time()
        for _ in range(number):
            call()
        taken = time.process_time() - start
        if taken >= at_least:
            break
        number *= 2
    best = taken / number
    for _ in range(repeats - 1):
        start = time.process_time()
        for _ in range(number):
            call()
        best = min(best, (time.process_time() - start) / number)
    return best


def field_of(stored: int, density: float, rows: int, seed: int = 1) -> tuple[SoBuffer, np.ndarray]:
    """Return a buffer with `stored` gradients of reach 1 m on a torus of the size that gives `density` [1/m2]."""
    side = float(np.sqrt(stored / density))
    rng = np.random.default_rng(seed)
    space = Torus(side, side)
    poses = OwnPoses(space, rows, np.arange(rows) * 0)
    buffer = SoBuffer(BufferSettings(aggregation_distance=0.0), space, poses)
    for start in range(0, stored, 10_000):
        count = min(10_000, stored - start)
        places = rng.random((count, 2)) * side
        buffer.store_static(0, "trail", places, 0.0, evaporation_factor=0.9, evaporation_period=30.0)
    poses.update(rng.random((rows, 2)) * side, np.zeros(rows), 0.0)
    return buffer, rng.random((100, 2)) * side


def ratio(name: str, what: str, ours: float) -> Result:
    """Return the line that compares one figure with the original's."""
    times = ORIGINAL[name] / ours
    line = (
        f"{ours * 1e6:9.2f} us  original {ORIGINAL[name] * 1e6:7.0f} us {times:6.0f} x (at least {REQUIRED[name]:.0f})"
    )
    return what, line, times >= REQUIRED[name]


def compare_with_original() -> list[Result]:
    """Return the three figures that the original has too."""
    buffer, _ = field_of(1000, 1000 / 121, rows=64)
    queries, everything = Queries(buffer), Filter(view_distance=np.inf, moving=False)
    near = cpu_seconds(lambda: queries.gather(0.0, None, Filter(moving=False))) / 64
    whole = cpu_seconds(lambda: queries.gather(0.0, None, everything)) / 64
    space = Torus(20.0, 20.0)
    poses = OwnPoses(space, 501)
    poses.update(np.random.default_rng(1).random((501, 2)) * 20, None, 0.0)
    fernandez = RepulsionFernandez(poses, view_distance=30.0)
    repel = cpu_seconds(lambda: fernandez.move(0.0)) / 501
    buffer, positions = field_of(1000, 1000 / 121, rows=1)
    buffer.store_static(0, "trail", positions, 0.0)
    store = cpu_seconds(lambda: buffer.store_static(0, "trail", positions, 0.0)) / 100
    return [
        ratio("query", "gradients in view, 1,000 stored, view 1.5 m, per robot", near),
        ratio("query", "gradients in view, 1,000 stored, all in view, per robot", whole),
        ratio("fernandez", "Fernandez repulsion, 500 neighbours in view, per robot", repel),
        ratio("store", "storing a static gradient beside 1,000, batches of 100", store),
    ]


def growth(rounds: int = 15, views: int = 50) -> list[Result]:
    """Return the growth of the cost of one view from 10^3 to 10^5 stored gradients at constant density.

    The sizes take turns, so that other work of the machine falls on all of them. The figures are medians over `rounds`.
    """
    look = Filter(moving=False)
    stores = [Queries(field_of(stored, 8.0, rows=64)[0]) for stored in (1_000, 10_000, 100_000)]
    times = np.zeros((rounds, len(stores)))  # [s]
    for turn in range(-1, rounds):  # turn -1 does not count: the last turn overwrites its place
        for size, queries in enumerate(stores):
            start = time.process_time()
            for _ in range(views):
                queries.gather(0.0, None, look)
            times[turn, size] = (time.process_time() - start) / (64 * views)
    grown = float(np.median(times[:, -1] / times[:, 0]))
    line = "  ".join(f"{t * 1e6:.2f} us" for t in np.median(times, axis=0))
    line += f"   grows {grown:.2f} x (at most {MOST_GROWTH} x)"
    return [("one view with 10^3, 10^4, 10^5 stored", line, grown < MOST_GROWTH)]


def memory() -> list[Result]:
    """Return the memory of a million stored gradients."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    buffer, _ = field_of(1_000_000, 8.0, rows=1)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 - before
    size = float(sum(field.nbytes for field in buffer.table.record if isinstance(field, np.ndarray)))
    line = f"{size / 1e6:.0f} MB of tables, peak while growing {peak / 1e6:.0f} MB (at most {MOST_MEMORY / 1e6:.0f})"
    return [("10^6 stored gradients", line, size < MOST_MEMORY)]


def ticks() -> list[Result]:
    """Return the cost of one call for 5 robots and for 64 worlds of 5."""
    lines: list[Result] = []
    for worlds in (1, 64):
        rows = 5 * worlds
        rng = np.random.default_rng(1)
        space = Torus(11.0, 11.0)
        poses = OwnPoses(space, rows, np.repeat(np.arange(worlds), 5))
        buffer = SoBuffer(BufferSettings(view_distance=4.0, aggregation_distance=0.1, min_diffusion=0.3), space, poses)
        positions, headings, clock = rng.random((rows, 2)) * 11, rng.random(rows), [0.0]

        def update(p=poses, x=positions, h=headings, c=clock) -> None:
            c[0] += 1e-6
            p.update(x, h, c[0])

        lines.append((f"{rows} rows: spread the poses", f"{cpu_seconds(update) * 1e6:9.2f} us", True))
        for world in range(worlds):
            buffer.store_static(world, "items", rng.random((10, 2)) * 11, 0.0)
            buffer.store_static(world, "trail", rng.random((3000, 2)) * 11, 0.0, attraction=-1)
        for name, mechanism in {
            "RepulsionFernandez": RepulsionFernandez(poses, view_distance=2.0),
            "RepulsionGradient": RepulsionGradient(poses),
            "ChemotaxisBalch, 10 items": ChemotaxisBalch(buffer, channels=["items"], view_distance=1.0),
            "Patrol, 3,000 pheromones a world": Patrol(buffer, channels=["trail"]),
        }.items():
            cost = cpu_seconds(lambda m=mechanism: m.move(0.0))
            lines.append((f"{rows} rows: {name}", f"{cost * 1e6:9.2f} us", True))
    return lines


def main() -> int:
    """Print every figure; return 1 if a required one is missed."""
    results = compare_with_original() + growth() + memory() + ticks()
    for what, line, good in results:
        print(f"{'' if good else 'MISSED '}{what:58s} {line}")
    return 0 if all(good for _, _, good in results) else 1


if __name__ == "__main__":
    sys.exit(main())
