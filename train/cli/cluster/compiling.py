"""Compiling everything at once, into a cache that later commands and other machines find full."""

from dataclasses import dataclass
from pathlib import Path
from time import process_time

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.learning.warm_up import one_process
from selforg.compiler.cache import cache_directory
from train.evaluation.experiment import ExperimentEvaluation
from train.evaluation.family import FamilyEvaluation
from train.evaluation.task_run import TaskRun, run_task, tasks_to_run
from train.request import Request
from train.running.runs import Job

EXPERIMENT, FAMILY = "table1", "crowded"
"""What is run: the experiment without batches, and the family with all options."""
TASK_SECONDS = 5.0
"""Simulated time of each task that is no cleaning [s]."""


@dataclass(frozen=True)
class CompiledCode:
    """What is on the disk after compiling."""

    directory: Path
    size: int
    """Of all files [byte]."""
    seconds: float
    """CPU time that this took [s]."""


def compile_everything() -> CompiledCode:
    """Run the beginnings of missions under every option, and of all tasks: whatever they call is compiled and kept.

    Raises:
        ConfigurationError: nothing can be kept.

    """
    directory, began = cache_directory(), process_time()
    if directory is None:
        raise ConfigurationError(
            "machine warm: no directory can be written or has room; NUMBA_CACHE_DIR names another one"
        )
    with one_process():
        batches = FamilyEvaluation(Request(FAMILY, ("fixed", "fsm:rule"), scenarios=1)).tasks({})
        single = ExperimentEvaluation(Request(EXPERIMENT, scenarios=1)).tasks({})
        tasks: list[Job] = [*batches, *single]
        for mission in tasks:
            mission.beginning().run()
        for task in tasks_to_run():
            run_task(TaskRun(task, scenarios=2, seconds=TASK_SECONDS))
    size = sum(path.stat().st_size for path in directory.rglob("*") if path.is_file())
    return CompiledCode(directory, size, process_time() - began)
