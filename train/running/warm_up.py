"""Compile before the runs, once and in one process, instead of in every worker at the same time."""

from pathlib import Path

from rich.console import Console

from clean_swarm_env.world import tick_kernels
from selforg.compiler.cache import folder_for
from selforg.compiler.switches import COMPILED
from train.running.runs import Task

EVERY_MISSION = Path(tick_kernels.__file__)
"""The file of kernels that every mission calls, and that only a running mission calls."""


def compile_first(task: Task) -> None:
    """Run the first second of one run, which compiles the kernels that all runs call."""
    announce()
    task.beginning().run()


def announce() -> None:
    """Print on the standard error that the kernels are being compiled."""
    Console(stderr=True, highlight=False, soft_wrap=True).print("compiling for this machine, once: about a minute")


def compiled_before() -> bool:
    """Tell whether the kernels of today's sources lie on the disk; true as well where nothing can be kept there."""
    folder = folder_for(str(EVERY_MISSION))
    return not COMPILED or folder is None or any(folder.rglob("*.nbi"))
