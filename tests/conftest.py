"""What all tests share.

Hypothesis sets no limit of time for an example, because a loaded machine is not a fault.

A suite started with Ctrl-C or hangups ignored (`nohup`, a background job of a shell) goes on ignoring them. The
commands that its tests start do not: a signal with a handler here has its default in a program started from here.

The files that take longest come first, so that no worker of pytest-xdist is alone with one at the end.

Plug-ins that a test names are forgotten after it: commands that later tests start would import them, too.
"""

import os
import signal

import pytest
from hypothesis import settings

from selforg.plugins import NAMED

settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")


LONG = (
    "train/learning/test_training.py",
    "docs/test_readme_commands.py",
    "train/cli/test_plugins.py",
    "docs/test_tutorials.py",
    "train/cluster/test_slurm.py",
    "train/cluster/test_dask_engine.py",
    "selforg/test_switches.py",
    "examples/test_examples.py",
    "clean_swarm_env/test_siblings.py",
    "train/studies/test_tuning_docs.py",
    "train/evaluation/test_shares.py",
    "docs/comparison/test_choosing.py",
    "train/cluster/test_clusters_docs.py",
    "train/cli/test_faults.py",
    "selector/store/test_store.py",
    "docs/comparison/test_scores_loop.py",
)
"""Files of a minute or more."""


def pytest_configure(config):
    """Let pytest-xdist, if it is there, keep the order of files; it would put those of few tests, the longest, last."""
    if hasattr(config.option, "loadscopereorder"):
        config.option.loadscopereorder = False


def pytest_collection_modifyitems(items):
    """Put the tests of long files first."""
    items.sort(key=lambda item: not item.path.as_posix().endswith(LONG))


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
