"""`python -m tests.clean_swarm_env.guarded_copies [COUNT] [FAULT]`: copies of random batches between guard pages.

Copies go on after their originals are gone, with the bits that the originals would have had. An address of an original
that survives in a copy ends the process by SIGSEGV. FAULT plants one: `address` gives a copy the words of its original,
`behind` lets a kernel write behind the end of an array.
"""

import faulthandler
import gc
import sys

import numpy as np

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.warm_up import run_through
from clean_swarm_env.tasks import TASKS
from selforg.arrays import Floats
from selforg.compiler.decorators import lean_kernel
from tests.clean_swarm_env.copies import WAYS, advance, random_batch
from tests.clean_swarm_env.courses import begun
from tests.guard_pages import guard
from tests.soaking import report, rounds

FAULTS = ("none", "address", "behind")


@lean_kernel
def write(array: Floats, place: int) -> None:
    """Write to a place of `array` (K,), whether it has that or not."""
    array[place] = 1.0


def random_kind(rng: np.random.Generator) -> Batch:
    """Return a batch that cleans, or now and then has another task, and has just begun."""
    if rng.random() < 0.7:
        return random_batch(rng)
    others = [name for name in TASKS.names() if name != "Cleaning"]
    task = others[int(rng.integers(len(others)))]
    return begun(Batch({"task": task, "time_limit": 10.0}), [int(rng.integers(1 << 30))])


def check(number: int, fault: str) -> None:
    """Copy a random batch at a random moment; the copy goes on alone, and so do states and copies of the copy."""
    rng = np.random.default_rng((2028, number))
    batch = random_kind(rng)
    advance(batch, rng, int(rng.integers(0, 20)))
    way, state = WAYS[list(WAYS)[number % len(WAYS)]], batch.get_state()
    orphan, course = way(batch), advance(batch, np.random.default_rng(number), 6)
    if fault == "address":
        orphan.worlds.minds.poses.packed.words[:] = batch.worlds.minds.poses.packed.words
    del batch
    gc.collect()
    assert advance(orphan, np.random.default_rng(number), 6) == course, number
    orphan.set_state(state)
    assert advance(way(orphan), np.random.default_rng(number), 6) == course, number


def main(count: int, fault: str) -> None:
    """Compile without guards, then check `count` batches."""
    faulthandler.enable()
    run_through(Batch())
    array = np.zeros(3)
    write(array, 0)
    guard()
    if fault == "behind":
        array = np.zeros(3)
        write(array, array.size)
    tried = 0
    for number in rounds(count):
        check(number, fault)
        tried += 1
    print(f"{tried} copies between guard pages: equal bits, no access outside")
    report(tried, tried)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100, sys.argv[2] if len(sys.argv) > 2 else "none")
