"""A fault made on purpose, and whether tests notice it."""

import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

CPU_LIMIT, LIMIT = 240, 1200
"""Seconds of the processor, and of the clock, after which the tests of a mutant are stopped."""
TOO_LONG = "a limit of time"
NO_TESTS = 5
"""What pytest ends with if all tests are marked `long`."""


class Mutant(NamedTuple):
    """One text of one file in place of another, and the tests that have to notice it."""

    name: str
    file: str
    before: str
    after: str
    tests: tuple[str, ...]
    start: int
    """Where `before` begins in the file [characters]."""
    compiled: bool = False
    """Whether the tests run with compiled kernels."""

    def applied(self, whole: str) -> str:
        """Return the file with the fault."""
        end = self.start + len(self.before)
        got = whole[self.start : end]
        if got != self.before:
            raise ValueError(f"{self.name}: expected {self.before!r} at {self.start} of {self.file}, got {got!r}")
        return whole[: self.start] + self.after + whole[end:]


def failure(tests: tuple[str, ...], sources: Path, compiled: bool = False) -> str:
    """Run tests on a copy of the sources; return the first that fails, what it took too long for, or nothing.

    Tests that are marked `long` take no part, as `pyproject.toml` says.
    """
    plain = {} if compiled else {"NUMBA_DISABLE_JIT": "1"}
    kept = {"PYTHONPATH": str(sources), "NUMBA_CACHE_DIR": str(kernels_of(sources))}
    environment = {**os.environ, **kept, **plain}
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
    with tempfile.TemporaryFile("w+") as said:  # a pipe would wait for the processes that a stopped test leaves
        try:
            done = subprocess.run(
                command, cwd=sources, env=environment, stdout=said, stderr=said, timeout=LIMIT, preexec_fn=limit_cpu
            )
        except subprocess.TimeoutExpired:
            return TOO_LONG
        said.seek(0)
        text = said.read()
    if done.returncode in (0, NO_TESTS):
        return ""
    if done.returncode not in (1, 2, 4, -signal.SIGXCPU, -signal.SIGKILL, -signal.SIGSEGV):
        raise RuntimeError(f"{tests}: pytest ended with {done.returncode}\n{text[-2000:]}")
    found = re.search(r"^(?:FAILED|ERROR) ([^\s[]+)", text, re.MULTILINE)  # with all its parameters
    return found[1] if found else TOO_LONG if done.returncode < 0 else tests[0]


def kernels_of(sources: Path) -> Path:
    """Return where the kernels of a copy of the sources are kept: nobody needs those of mutants later."""
    return sources.with_name("kernels")


def limit_cpu() -> None:
    """Limit the time of the processor, which a busy machine does not use up."""
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_LIMIT, CPU_LIMIT))


def noticed(mutant: Mutant, sources: Path) -> str:
    """Return which test of a mutant fails on it and passes without it, "" if none does.

    sources: a copy, which is as before afterwards.
    """
    path = sources / mutant.file
    whole = path.read_text(encoding="utf-8")
    path.write_text(mutant.applied(whole), encoding="utf-8")
    try:
        found = failure(mutant.tests, sources, mutant.compiled)
    finally:
        path.write_text(whole, encoding="utf-8")
    if found in ("", TOO_LONG) or not failure((found,), sources, mutant.compiled):
        return found
    if mutant.compiled:
        raise RuntimeError(f"{found}: expected to pass without a mutant")
    return noticed(mutant._replace(compiled=True), sources)
