"""A plug-in of pytest that measures each test file and fixture: `-p tests.rings.timing`.

It adds lines to the file that the variable `CLEAN_SWARM_TIMES` names: kind, name, number of tests, seconds of CPU with
those of ended child processes, and of the clock. Every process of pytest-xdist writes its own.
"""

import json
import os
import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from tests.paths import ROOT

TIMES = "CLEAN_SWARM_TIMES"
"""Variable of the environment with the file for what is measured."""
SHARED_SCOPES = ("module", "package", "session")
"""Scopes of fixtures that are listed by themselves; the others count as their tests."""


def cpu_seconds():
    """Return the seconds of CPU of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


@contextmanager
def measured(kind: str, name: str, tests: int = 0) -> Iterator[None]:
    """Write what the block takes."""
    cpu, wall = cpu_seconds(), time.monotonic()
    yield
    line = json.dumps([kind, name, tests, cpu_seconds() - cpu, time.monotonic() - wall])
    with open(os.environ[TIMES], "a", encoding="utf-8") as file:
        file.write(line + "\n")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    """Measure a test with its fixtures."""
    with measured("file", item.path.relative_to(ROOT / "tests").as_posix(), 1):
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef):
    """Measure a fixture that several tests share."""
    if fixturedef.scope not in SHARED_SCOPES:
        return (yield)
    with measured("fixture", f"{fixturedef.baseid.removeprefix('tests/')}: {fixturedef.argname}"):
        return (yield)
