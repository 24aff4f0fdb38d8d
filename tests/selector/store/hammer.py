"""`python -m tests.selector.store.hammer URL [PROCESSES] [UPDATES]`: many processes update one store at the same time.

A program of its own because it forks: in a process without threads that is safe, and nothing is imported twice.
"""

import os
import sys
import time

import numpy as np

from selector.store import KnowledgeStore, RewardSums
from selector.store.exact_sums import NO_REWARDS, Moments

GOAL, OPTIONS = "Avoid", ("near", "far")
SOURCES = 3
"""Processes that share a source update the same entries."""


def rewards(process: int, updates: int) -> np.ndarray:
    """Return the rewards (updates,) that a process gives, of all sizes."""
    random = np.random.default_rng(process)
    return random.uniform(-1.0, 1.0, updates) * 10.0 ** random.integers(-6, 6, updates)


def update(url: str, process: int, updates: int) -> None:
    store = KnowledgeStore(url)  # the first process to come makes it
    for number, reward in enumerate(rewards(process, updates)):
        batch = RewardSums(GOAL, OPTIONS)
        batch.record(np.array([number % 2]), np.array([reward]))
        store.add(batch, source=f"run-{process % SOURCES}")
    store.close()


def expected(processes: int, updates: int) -> dict[tuple[str, str], Moments]:
    """Return the exact sums of all updates, by option and source."""
    found: dict[tuple[str, str], Moments] = {}
    for process in range(processes):
        sums = RewardSums(GOAL, OPTIONS)
        sums.record(np.arange(updates) % 2, rewards(process, updates))
        for (option, _), moments in sums.moments.items():
            key = option, f"run-{process % SOURCES}"
            found[key] = found.get(key, NO_REWARDS) + moments
    return found


def main(arguments: list[str]) -> int:
    url, processes, updates = arguments[0], int((arguments[1:] or ["8"])[0]), int((arguments[2:] or ["500"])[0])
    began = time.perf_counter()
    children = []
    for process in range(processes):
        child = os.fork()
        if child == 0:
            update(url, process, updates)
            os._exit(0)
        children.append(child)
    failed = sum(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) != 0 for child in children)
    seconds = time.perf_counter() - began
    store = KnowledgeStore(url, create=False)
    learned = store.contents().learned
    held = {(key.option, key.source): entry.moments for key, entry in learned.items()}
    counted = sum(moments.count for moments in store.contents().totals().values())
    exact = held == expected(processes, updates)
    print(f"{counted} of {processes * updates} updates counted, exact: {exact}, {failed} failed, {seconds:.1f} s")
    return 0 if exact and counted == processes * updates and not failed else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
