"""`make soak`: all long random tests side by side within half an hour, and a table of what they tried.

`python -m tests.soak [NAME...]` runs those whose names begin so, or all. Each has a limit of time for two CPUs; fewer
CPUs shorten it.
"""

import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

from clean_swarm_env.learning.warm_up import usable_cpus
from tests.attacks.targets import TARGETS
from tests.paths import ROOT
from tests.soaking import SECONDS

CPUS = 2
"""Processors for which the limits of time are made: together they take 27 minutes there."""
FUZZ_SECONDS = 50.0


class Soak(NamedTuple):
    """A long random test: a module that ends with the line of `tests.soaking.report`."""

    name: str
    words: tuple[str, ...]
    """Module and arguments."""
    asked: int
    """What it tries if there is time enough."""
    seconds: float
    """Limit of time."""


SOAKS = (
    Soak("hours of a week of one mission", ("tests.clean_swarm_env.soak_week",), 168, 700.0),
    Soak("copies and states of random missions", ("tests.clean_swarm_env.soak_copies",), 1000, 350.0),
    Soak("copies between guard pages", ("tests.clean_swarm_env.guarded_copies",), 100, 150.0),
    Soak("random networks, 50 steps", ("tests.selforg.network.soak",), 10_000, 250.0),
    Soak("sequences of messages", ("tests.selforg.gradients.fuzz",), 100_000, 250.0),
    Soak("kills of processes with a store", ("tests.selector.store.killing", "2000"), 2000, 250.0),
    Soak("periods of switching options", ("tests.selector.coordination.soak_switching",), 3600, 250.0),
    *(Soak(f"contents: {name}", ("tests.attacks.soak", name), 100_000, FUZZ_SECONDS) for name in TARGETS),
)
"""The longest first, so that all processors are busy to the end."""


def outcome_of(soak: Soak, share: float) -> tuple[str, str]:
    """Run a soak in a process of its own, with a share of its time; return its row and, if it failed, what it said."""
    began = time.monotonic()
    environment = {**os.environ, SECONDS: f"{share * soak.seconds:g}"}
    command = [sys.executable, "-m", *soak.words]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    lines = re.findall(r"^tried (\d+), survived (\d+)$", done.stdout, re.MULTILINE)
    tried, survived = map(int, lines[-1]) if lines else (0, 0)
    row = f"| {soak.name} | {soak.asked:,} | {tried:,} | {survived:,} | {time.monotonic() - began:.0f} |"
    passed = done.returncode == 0 and tried == survived > 0
    return row, "" if passed else f"FAILED\n{done.stdout[-3000:]}{done.stderr[-3000:]}"


def main(arguments: list[str]) -> int:
    """Run the soaks; return 1 if one failed."""
    chosen = [soak for soak in SOAKS if not arguments or soak.name.startswith(tuple(arguments))]
    cpus, began, failed = usable_cpus(), time.monotonic(), False
    rows = ["| soak | asked | tried | survived | seconds |", "|---|---:|---:|---:|---:|"]
    with ThreadPoolExecutor(cpus) as pool:
        for row, fault in pool.map(lambda soak: outcome_of(soak, min(1.0, cpus / CPUS)), chosen):
            print(row, fault, flush=True)
            rows.append(row)
            failed |= bool(fault)
    print(*["", *rows], sep="\n")
    print(f"{(time.monotonic() - began) / 60:.1f} minutes on {cpus} CPUs")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
