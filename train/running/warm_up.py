"""Compile the kernels before the runs, once and in one process: workers would compile them all at the same time."""

from clean_swarm_env.learning.warm_up import announce, one_process
from train.running.runs import Job


def compile_first(task: Job) -> None:
    """Do the beginning of one run, which compiles the kernels that all runs call."""
    with one_process():
        announce()
        task.beginning().run()
