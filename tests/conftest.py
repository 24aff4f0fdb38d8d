"""What all tests share.

Hypothesis sets no limit of time for an example, because a loaded machine is not a fault.

A suite started with Ctrl-C or hangups ignored (`nohup`, a background job of a shell) goes on ignoring them. The
commands that its tests start do not: a signal with a handler here has its default in a program started from here.

The files that take longest by `tests/durations.csv` come first, so that no worker of pytest-xdist is alone with one at
the end.

Plug-ins that a test names are forgotten after it: commands that later tests start would import them, too.
"""

import gc
import os
import signal

import pytest
from hypothesis import settings

from selforg.plugins import NAMED
from tests.paths import ROOT
from tests.rings.durations import order

settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")


def pytest_configure(config):
    """Let pytest-xdist, if it is there, keep the order of files; it would put those of few tests, the longest, last."""
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False


def pytest_collection_finish():
    """Let the collector leave out all that was imported; tests that collect would look through it each time."""
    gc.freeze()


def pytest_collection_modifyitems(items):
    """Put the files that take longest first, after those that are not known yet."""
    places = order()
    items.sort(key=lambda item: places.get(item.path.relative_to(ROOT / "tests").as_posix(), -1))


def ignore(*_: object) -> None:
    """Handle a signal by doing nothing."""


for name in ("SIGINT", "SIGHUP"):
    number = getattr(signal, name, None)  # not every system has all
    if number is not None and signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, ignore)


@pytest.fixture(autouse=True)
def no_plugins_of_other_tests():
    """Name no plug-in when a test begins."""
    os.environ.pop(NAMED, None)
