"""`python -m tests.clean_swarm_env.guarded_copies [COUNT] [FAULT]`: copies of random batches between guard pages.

Copies go on after their originals are gone, with the bits that the originals would have had. An address of an original
that survives in a copy ends the process by SIGSEGV. FAULT plants one: `address` gives a copy the words of its original,
`behind` lets a kernel write behind the end of an array.
"""

import copy
import faulthandler
import gc
import sys

import numpy as np

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.warm_up import run_through
from selforg.arrays import Floats
from selforg.compiler.decorators import lean_kernel
from tests.clean_swarm_env.copies import advance
from tests.clean_swarm_env.courses import begun
from tests.clean_swarm_env.soak_copies import check_round
from tests.guard_pages import guard
from tests.soaking import report, rounds


@lean_kernel
def write(array: Floats, place: int) -> None:
    """Write to a place of `array` (K,), whether it has that or not."""
    array[place] = 1.0


def plant_address() -> None:
    """Give a copy the words of its original, which ends first."""
    original = begun(Batch(), [1])
    orphan = copy.deepcopy(original)
    orphan.worlds.minds.poses.packed.handle[:] = original.worlds.minds.poses.packed.handle
    del original
    gc.collect()
    advance(orphan, np.random.default_rng(1), 6)


def main(count: int, fault: str) -> None:
    """Compile without guards, then check `count` batches."""
    faulthandler.enable()
    run_through(Batch())
    array = np.zeros(3)
    write(array, 0)
    guard()
    if fault == "address":
        plant_address()
    if fault == "behind":
        array = np.zeros(3)
        write(array, array.size)
    tried = 0
    for number in rounds(count):
        check_round(number)
        tried += 1
    print(f"{tried} copies between guard pages: equal bits, no access outside")
    report(tried, tried)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100, sys.argv[2] if len(sys.argv) > 2 else "none")
