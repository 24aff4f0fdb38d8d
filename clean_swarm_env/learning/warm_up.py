"""Compile the kernels before the first mission of a machine, in one process, and say so.

Why this takes so long, and what was tried: docs/decisions/0184-first-start.md.
"""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from clean_swarm_env.tasks.cleaning import cargo
from selforg.compiler.cache import cache_directory, folder_for
from selforg.compiler.switches import COMPILED

try:
    import fcntl
except ImportError:  # Windows: processes that start side by side each compile
    fcntl = None  # type: ignore[assignment]

WARM_UP_PERIODS = 300
"""Decision periods within which a mission has called every kernel that missions call."""
EVERY_MISSION = Path(cargo.__file__)
"""File of kernels that every mission calls and nothing else does: checking a configuration does not compile them."""
COMPILING = "compiling for this machine, once: about a minute"
SILENCED = "CLEAN_SWARM_QUIET"
"""Variable of the environment that silences the line, if it is 1."""
_checked: list[bool] = []
"""Not empty once this process has checked that the kernels are compiled, or compiles them."""
_holding: list[bool] = []
"""Not empty while this process lets no other pass."""


def compile_once(work: Callable[[], object]) -> None:
    """Do `work`, which compiles the kernels, unless they are on the disk; other processes wait meanwhile."""
    if _checked:
        return
    _checked.append(True)
    with one_process():
        if not compiled_before():
            announce()
            work()


def run_through(batch: Any) -> None:  # noqa: ANN401  (a Batch, which stands above this module)
    """Run the first mission of a batch with all options, which calls the kernels that all missions call."""
    batch.reset([0] * batch.count)
    options = np.arange(batch.rows) % batch.choices.counts[0]
    while not batch.step(options).terminated[0] and batch.steps(0) < WARM_UP_PERIODS:
        pass


def announce() -> None:
    """Print on the standard error that the kernels are being compiled."""
    if os.environ.get(SILENCED) != "1":
        print(COMPILING, file=sys.stderr, flush=True)


def compiled_before() -> bool:
    """Return whether the kernels of the present sources are on the disk; True as well where none can be kept."""
    folder = folder_for(str(EVERY_MISSION))
    return not COMPILED or folder is None or any(folder.rglob("*.nbi"))


@contextmanager
def one_process() -> Iterator[None]:
    """Let no other process of this cache pass meanwhile; within another such block this one does nothing."""
    directory = cache_directory()
    if fcntl is None or directory is None or _holding:
        yield
        return
    with (directory / "compiling.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        _holding.append(True)
        try:
            yield
        finally:
            _holding.clear()
