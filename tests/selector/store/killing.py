"""`python -m tests.selector.store.killing URL [KILLS] [SEED]`: kills processes that open and update a store.

URL names one database, or has a `{}` in it where a number makes a new one of every tenth kill, so that kills hit the
making of a store as well. Each process says when an update was committed; after each kill the store is read, and holds
every update that was said to be committed, whole, and at most one more, which was committed but not yet said. What
the last kills have left is looked at again after each of the next, up to ten.
"""

import os
import signal
import sys
import time
from contextlib import suppress

import numpy as np

from selector.store import KnowledgeStore, Moments, RewardSums
from tests.soaking import rounds

GOAL, OPTIONS = "Avoid", ("near", "far")
SAME_STORE = 10
OPENING, UPDATING = 0.08, 0.03
"""Longest time until a kill [s]: of a process that opens the store, and of one that has made its first update."""


def update_until_killed(url: str, source: str, said: int) -> None:
    """Give both options the rewards 0, 1, 2 ..., one update each, and say so after each commit."""
    store = KnowledgeStore(url)
    number = 0
    while True:
        batch = RewardSums(GOAL, OPTIONS)
        batch.record(np.array([0, 1]), np.array([number, number], dtype=float))
        store.add(batch, source=source)
        os.write(said, b".")
        number += 1


def kill_one(url: str, source: str, after: float, *, updating: bool) -> int:
    """Kill a process some time after its start or its first update; return the commits that it has told of."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        with suppress(BaseException):
            update_until_killed(url, source, write)
        os._exit(1)
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


def wrong(url: str, told: dict[str, int]) -> list[str]:
    """Return what the store lacks of the commits told of, or holds beyond them."""
    store = KnowledgeStore(url)
    held = {key: entry.moments for key, entry in store.contents().learned.items()}
    store.close()
    found = []
    for source, commits in told.items():
        near, far = (
            next((m for key, m in held.items() if (key.option, key.source) == (option, source)), Moments(0, 0, 0))
            for option in OPTIONS
        )
        total = near.count * (near.count - 1) // 2 << 24
        if near != far or near.total != total or not commits <= near.count <= commits + 1:
            found.append(f"{source}: {commits} commits, but {near} and {far}")
    return found


def kill_many(url: str, kills: int, seed: int = 0) -> tuple[int, int]:
    """Kill processes, and return the number of kills and of mistakes in what they left."""
    random, began = np.random.default_rng(seed), time.perf_counter()
    told: dict[str, int] = {}
    commits, mistakes, early, tried = 0, list[str](), 0, 0
    for kill in rounds(kills):
        here = url.replace("{}", str(kill // SAME_STORE))
        if kill % SAME_STORE == 0:
            told = {}
        source = f"killed-{kill}"
        updating = kill % 2 == 1
        after = random.uniform(0.0, UPDATING if updating else OPENING)
        told[source] = kill_one(here, source, after, updating=updating)
        commits += told[source]
        early += told[source] == 0
        mistakes += wrong(here, told)
        tried += 1
    print(*mistakes[:SAME_STORE], sep="\n", end="\n" if mistakes else "")
    seconds = time.perf_counter() - began
    print(
        f"{tried} kills ({early} before the first commit), {commits} commits told of, "
        f"{len(mistakes)} mistakes, {seconds:.1f} s"
    )
    return tried, len(mistakes)


def main(arguments: list[str]) -> int:
    url, kills, seed = arguments[0], int((arguments[1:] or ["200"])[0]), int((arguments[2:] or ["0"])[0])
    return 1 if kill_many(url, kills, seed)[1] else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
