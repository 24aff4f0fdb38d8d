"""Worlds in one process that several threads step: how many times faster than one thread, and what holds them back.

    python -m benchmarks.threads [THREADS]

Wall time of decision periods, in short rounds of every number of threads by turns: the best rounds are compared, since
a busy machine makes rounds slower and never faster. The median is printed beside them. `locked` is the share of one
thread's CPU time outside of the kernels that run without Python's lock: only one thread can be there.
"""

import sys
from collections.abc import Callable
from statistics import median
from time import perf_counter, thread_time
from typing import Any

import numpy as np

from benchmarks.shared.record import record
from benchmarks.shared.scenes import mission_of
from clean_swarm_env.learning.joined import Joined, batches_of
from clean_swarm_env.learning.warm_up import usable_cpus
from selforg.compiler.decorators import KERNELS, UNLOCKED

SIZES = ((64, 5), (256, 5), (8, 50), (2, 1000))
"""Worlds, and robots of each."""
PERIODS, ROUNDS = 4, 25


def stepping(worlds: int, robots: int, threads: int) -> Callable[[], float]:
    """Return a contestant that gives the wall seconds of a decision period."""
    joined = Joined(batches_of(mission_of(robots), worlds, threads), threads)
    joined.reset(range(worlds))
    drawn = np.random.default_rng(1).integers(0, joined.batches[0].choices.counts[0], (PERIODS, joined.rows))

    def step() -> float:
        begin = perf_counter()
        for options in drawn:
            joined.step(options)
        return (perf_counter() - begin) / PERIODS

    return step


def locked_share(worlds: int, robots: int) -> float:
    """Return the share of a period outside of kernels that hold no lock, by the CPU time of one thread."""
    inside: list[float] = []
    unlocked = {id(one) for one in KERNELS.values() if one.targetoptions.get(*UNLOCKED)}
    owners = [owner for owner in sys.modules.values() if hasattr(owner, "__file__")]
    owners += [one for owner in owners for one in vars(owner).values() if isinstance(one, type)]
    places = {
        (id(owner), name): (owner, name, value)
        for owner in owners
        for name, value in list(vars(owner).items())
        if id(getattr(value, "__func__", value)) in unlocked
    }.values()

    def timed(kernel: Any) -> Any:
        def call(*given: Any) -> Any:
            begin = thread_time()
            result = kernel(*given)
            inside.append(thread_time() - begin)
            return result

        return call

    step = stepping(worlds, robots, 1)
    step()
    for owner, name, value in places:
        is_static = isinstance(value, staticmethod)
        setattr(owner, name, staticmethod(timed(value.__func__)) if is_static else timed(value))
    try:
        shares = []
        for _ in range(ROUNDS):
            inside.clear()
            begin = thread_time()
            step()
            whole = thread_time() - begin
            shares.append(1.0 - sum(inside) / whole)
    finally:
        for owner, name, value in places:
            setattr(owner, name, value)
    return median(shares)


def main(arguments: list[str]) -> None:
    """Print and record the figures."""
    most = int(arguments[0]) if arguments else usable_cpus()
    figures: dict[str, dict[str, float]] = {}
    for worlds, robots in SIZES:
        steps = {threads: stepping(worlds, robots, threads) for threads in range(1, most + 1)}
        rounds = [{threads: step() for threads, step in steps.items()} for _ in range(ROUNDS + 1)][1:]
        own = figures[f"{worlds} x {robots}"] = {"locked": locked_share(worlds, robots)}
        for threads in range(2, most + 1):
            best = [min(times[count] for times in rounds) for count in (1, threads)]
            middle = median(times[1] / times[threads] for times in rounds)
            own |= {f"{threads} threads": best[0] / best[1], f"{threads} threads, median": middle}
        own["a period, 1 thread [ms]"] = 1e3 * min(times[1] for times in rounds)
        print(f"{worlds} x {robots}:", ", ".join(f"{name} {figure:.2f}" for name, figure in own.items()))
    record("threads", figures)


if __name__ == "__main__":
    main(sys.argv[1:])
