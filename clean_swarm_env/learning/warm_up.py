"""Compile the kernels before the first mission of a machine, in as many processes as there are cores, and say so.

One process begins, and other commands wait for it. It starts helpers, which all take kernels from one list and leave
the compiled code on the disk. What helpers do not do, as when they die, the process compiles itself.

Why this takes so long, and what was tried: docs/decisions/0184-first-start.md.
"""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from subprocess import DEVNULL, Popen, TimeoutExpired
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from clean_swarm_env.config.task_names import TASKS_HOME
from selforg.compiler.ahead import compile_line
from selforg.compiler.cache import cache_directory
from selforg.compiler.decorators import KERNELS
from selforg.compiler.switches import COMPILED, PLAIN
from selforg.components.robot import list_turns

try:
    import fcntl
except ImportError:  # Windows: processes that start side by side each compile
    fcntl = None  # type: ignore[assignment]

WARM_UP_PERIODS = 300
"""Decision periods within which a mission has called every kernel that missions call."""
EVERY_MISSION = f"{list_turns.__module__}.{list_turns.__name__}"
"""A kernel that every mission calls and nothing else does: checking a configuration does not compile it."""
COMPILING = "compiling this copy of the package for this machine, once: about a minute"
SILENCED = "CLEAN_SWARM_QUIET"
"""Variable of the environment that silences the line, if it is 1."""
FIRST_KERNELS = Path(__file__).with_name("first_kernels.txt")
"""The kernels that the first mission needs, those that take longest first, and `EVERY_MISSION` last.

`python -m benchmarks.first_start --list` writes it."""
MOST_PROCESSES = 6
"""Processes that compile: the longest kernel takes a sixth of the time of all."""
HELPERS_WAIT = 300.0
"""Seconds for which the last kernels of helpers are waited for."""
HELPER = """
import os, sys
sys.path[:] = sys.argv[3:]
import clean_swarm_env.learning.batch
from clean_swarm_env.learning.warm_up import compile_share
compile_share(sys.argv[1], int(sys.argv[2]))
"""
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
            compile_listed()
            work()


def run_through(batch: Any) -> None:  # noqa: ANN401  (a Batch, which stands above this module)
    """Run the first mission of a batch with all options, which calls the kernels that all missions call."""
    batch.reset([0] * batch.count)
    options = np.arange(batch.rows) % batch.choices.counts[0]
    while not batch.step(options).terminated[0] and batch.steps(0) < WARM_UP_PERIODS:
        pass


def compile_listed() -> None:
    """Say that the kernels are being compiled, and compile those of the list, with other processes where it can."""
    if os.environ.get(SILENCED) != "1":
        print(COMPILING, file=sys.stderr, flush=True)
    count = min(usable_cpus(), MOST_PROCESSES) - 1
    if count < 1 or PLAIN or not Path(sys.executable).name.startswith("py"):  # else it may be any program
        return
    with suppress(OSError), TemporaryDirectory() as claims:  # no room, or no more processes: the work compiles all
        words = [sys.executable, "-P", "-c", HELPER, claims, str(os.getpid()), *sys.path]
        helpers: list[Popen[bytes]] = []
        try:
            for _ in range(count):
                helpers.append(Popen(words, stdin=DEVNULL, stdout=DEVNULL, stderr=DEVNULL))
            compile_share(claims)
            for helper in helpers:
                with suppress(TimeoutExpired):
                    helper.wait(HELPERS_WAIT)
        finally:
            for helper in helpers:
                helper.kill()
                helper.wait()


def compile_share(claims: str, parent: int = 0) -> None:
    """Compile the kernels of the list that no other process has claimed in a directory.

    A helper ends when its parent has gone. Whatever goes wrong is left to the first mission, which meets it again.
    """
    import_module(TASKS_HOME)
    for number, line in enumerate(FIRST_KERNELS.read_text(encoding="utf-8").splitlines()):
        if parent not in (0, os.getppid()):
            return
        with suppress(Exception):  # claimed by another, or of an older list
            if line.partition(" ")[0] in KERNELS:
                Path(claims, str(number)).touch(exist_ok=False)
                compile_line(line)


def usable_cpus() -> int:
    """Return the number of CPUs that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def compiled_before() -> bool:
    """Return whether the kernels of the present sources are on the disk; True as well where none can be kept."""
    return not COMPILED or cache_directory() is None or KERNELS[EVERY_MISSION]._cache.is_kept()


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
