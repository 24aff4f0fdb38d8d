"""What long random tests have in common: a limit of time, and a last line that the table of `make soak` reads."""

import gc
import os
import resource
import time
from collections.abc import Iterator
from pathlib import Path

SECONDS = "SOAK_SECONDS"
"""Variable of the environment: seconds after which a soak begins no further round; no limit unless set."""


def time_limit() -> float:
    """Return the limit of time [s]."""
    return float(os.environ.get(SECONDS, "inf"))


def rounds(count: int, first: int = 0) -> Iterator[int]:
    """Yield numbers of rounds from `first` on until there were `count`, or the time is over."""
    end = time.monotonic() + time_limit()
    for number in range(first, first + count):
        if time.monotonic() > end:
            return
        yield number


def report(tried: int, survived: int) -> None:
    """Print the line that the table reads."""
    print(f"tried {tried}, survived {survived}", flush=True)


def resident() -> int:
    """Return the memory that the process has now [bytes]; Linux only."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize()
