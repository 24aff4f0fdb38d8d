"""Processes that update one store at the same time, and processes that are killed.

`python -m tests.selector.store.killing [KILLS] [PROCESSES] [UPDATES] [SEED]` is a program of its own because it forks:
in a process without threads that is safe, and nothing is imported twice. A new store begins with every tenth
kill, so that kills hit the making of a store as well. A process says when an update was committed; after each kill the
store holds every update that was said to be committed, whole, and at most one more, committed but not yet said.
"""

import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from selector.store import KnowledgeStore, Moments, RewardSums
from selector.store.exact_sums import NO_REWARDS
from tests.soaking import report, rounds

GOAL, OPTIONS = "Avoid", ("near", "far")
SAME_STORE = 10
OPENING, UPDATING = 0.08, 0.1
"""Longest time until a kill [s]: of a process that opens the store, and of one that has made its first update."""


def batch_of(options: np.ndarray, rewards: np.ndarray) -> RewardSums:
    made = RewardSums(GOAL, OPTIONS)
    made.record(options, rewards)
    return made


def forked(work: Callable[[], None]) -> int:
    """Return the number of a process that does some work and ends with 0, or with 1 if it failed."""
    child = os.fork()
    if child == 0:
        with suppress(BaseException):
            work()
            os._exit(0)
        os._exit(1)
    return child


def lost_updates(path: Path, processes: int, updates: int) -> int:
    """Let processes add the rewards 0, 1, 2 ... to the same entry at the same time; return how many went wrong."""

    def update() -> None:
        store = KnowledgeStore(path)  # the first process to come makes it
        for number in range(updates):
            store.add(batch_of(np.zeros(1, int), np.array([float(number)])), source="all")

    children = [forked(update) for _ in range(processes)]
    failed = sum(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) != 0 for child in children)
    (entry,) = KnowledgeStore(path).contents().learned.values()
    total, squares = (sum(number**power for number in range(updates)) for power in (1, 2))
    return failed + (entry.moments != Moments(processes * updates, processes * total << 24, processes * squares << 48))


def kill_one(path: Path, source: str, after: float, *, updating: bool) -> int:
    """Kill a process some time after its start or its first update; return the commits that it has told of."""
    read, write = os.pipe()

    def update_until_killed() -> None:
        """Give both options the rewards 0, 1, 2 ..., one update each, and say so after each commit."""
        store, number = KnowledgeStore(path), 0
        while True:
            store.add(batch_of(np.arange(2), np.full(2, float(number))), source=source)
            os.write(write, b".")
            number += 1

    child = forked(update_until_killed)
    os.close(write)
    told = os.read(read, 1) if updating else b""
    time.sleep(after)
    os.kill(child, signal.SIGKILL)
    if os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) != -signal.SIGKILL:
        raise AssertionError(f"{source}: the process ended by an error before it was killed")
    while chunk := os.read(read, 1 << 16):
        told += chunk
    os.close(read)
    return len(told)


def wrong(path: Path, told: dict[str, int]) -> int:
    """Return of how many sources the store lacks a commit told of, or holds more than one beyond them."""
    held, found = KnowledgeStore(path).contents().learned, 0
    for source, commits in told.items():
        near, far = (
            next((e.moments for key, e in held.items() if (key.option, key.source) == (option, source)), NO_REWARDS)
            for option in OPTIONS
        )
        total = near.count * (near.count - 1) // 2 << 24
        found += near != far or near.total != total or not commits <= near.count <= commits + 1
    return found


def kill_many(folder: Path, kills: int, seed: int = 0) -> tuple[int, int]:
    """Kill processes, and return the number of kills and of mistakes in what they left."""
    random, told, tried, mistakes = np.random.default_rng(seed), dict[str, int](), 0, 0
    for kill in rounds(kills):
        path, source, updating = folder / f"{seed}-{kill // SAME_STORE}.sqlite", f"killed-{kill}", kill % 2 == 1
        if kill % SAME_STORE == 0:
            told = {}
        after = random.uniform(0.0, UPDATING if updating else OPENING)
        told[source] = kill_one(path, source, after, updating=updating)
        mistakes += wrong(path, told)
        tried += 1
    return tried, mistakes


def main(arguments: list[str]) -> int:
    numbers = [int(word) for word in arguments]
    kills, processes, updates, seed = [*numbers, *(200, 8, 500, 0)[len(numbers) :]]
    with tempfile.TemporaryDirectory() as folder:
        lost = lost_updates(Path(folder) / f"{seed}.sqlite", processes, updates)
        tried, mistakes = kill_many(Path(folder), kills, seed)
    print(f"{lost} of {processes} processes lost updates")
    report(tried, tried - mistakes)
    return 1 if lost or mistakes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
