"""Compile the kernels before the runs, once and in one process: workers would compile them all at the same time."""

from pathlib import Path

from rich.console import Console

from clean_swarm_env.world import tick_kernels
from selforg.compiler.cache import folder_for
from selforg.compiler.switches import COMPILED
from train.running.runs import Task

EVERY_MISSION = Path(tick_kernels.__file__)
"""File of kernels that every mission calls and nothing else does: checking a configuration does not compile them."""


def compile_first(task: Task) -> None:
    """Do the beginning of one run, which compiles the kernels that all runs call."""
    announce()
    task.beginning().run()


def announce() -> None:
    """Print on the standard error that the kernels are being compiled."""
    Console(stderr=True, highlight=False, soft_wrap=True).print("compiling for this machine, once: about a minute")


def compiled_before() -> bool:
    """Return whether the kernels of the present sources are on the disk; True as well where none can be kept."""
    folder = folder_for(str(EVERY_MISSION))
    return not COMPILED or folder is None or any(folder.rglob("*.nbi"))
