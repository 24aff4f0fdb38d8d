"""Compiling before the runs: once and in one process, instead of in every worker at the same time."""

from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

from rich.console import Console

from train.running.runs import MissionRunner, RunTask, execute


def compile_first(task: RunTask, run_mission: MissionRunner) -> None:
    """Run the first control periods of a task if nothing was ever compiled here, and say so on the standard error."""
    if compiled_before():
        return
    Console(stderr=True, highlight=False, soft_wrap=True).print("compiling for this machine, once: about a minute")
    execute(replace(task, mission=task.mission.model_copy(update={"time_limit": 1.0})), run_mission)


def compiled_before() -> bool:
    """Tell whether compiled code lies beside the package; where it cannot be kept there, a short run costs little."""
    spec = find_spec("selforg")
    places = spec.submodule_search_locations if spec and spec.submodule_search_locations else ()
    return any(any(Path(place).rglob("*.nbi")) for place in places)
