"""Compile before the runs: once and in one process, instead of in every worker at the same time."""

from pathlib import Path

from rich.console import Console

from clean_swarm_env.world import robot
from selforg.compiler.cache import folder_for
from selforg.compiler.switches import COMPILED
from train.running.runs import Task

EVERY_MISSION = Path(robot.__file__)
"""A file whose kernels every mission calls, and only a running one."""


def compile_first(task: Task) -> None:
    """Do the first second of a run, which compiles what all runs need."""
    announce()
    task.beginning().run()


def announce() -> None:
    """Say on the standard error why nothing else happens for a while."""
    Console(stderr=True, highlight=False, soft_wrap=True).print("compiling for this machine, once: about a minute")


def compiled_before() -> bool:
    """Tell whether the kernels of today's sources lie on the disk; true as well where nothing can be kept there."""
    folder = folder_for(str(EVERY_MISSION))
    return not COMPILED or folder is None or any(folder.rglob("*.nbi"))
