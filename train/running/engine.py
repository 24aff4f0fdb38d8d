"""The one seam through which tasks are spread: an engine does tasks, in processes of this machine or elsewhere."""

from collections.abc import Callable, Generator, Sequence
from contextlib import AbstractContextManager
from typing import Any, Protocol

from clean_swarm_env.learning.warm_up import compile_listed, one_process
from train.running.runs import Work
from train.running.trial_task import TrialTask

Round = Callable[[Sequence[Work]], Generator[Any, None, None]]
"""A function that does tasks, and yields what they yield, each when it is done, in any order."""

MOST_DEATHS = 3
"""Times that a task may lose its worker: it is begun once and run again twice."""


class Engine(Protocol):
    """What does tasks."""

    def rounds(self) -> AbstractContextManager[Round]:
        """Return a context with a function that does some tasks, by workers that stay for the tasks after them.

        Closing its iterator, or an error in a task, ends the other tasks at once. `WorkerLost` comes when all runs that
        were done have been yielded.
        """


class WorkerLost(Exception):
    """A task lost its worker again and again; the message names the task."""

    def __init__(self, task: Work, deaths: int = MOST_DEATHS) -> None:
        (scenario, condition), *others = task.keys
        more = f" (and up to {len(others)} more runs)" if others else ""
        super().__init__(f"scenario {scenario}, condition {condition}{more}: its worker died {deaths} times")


def in_turn(tasks: Sequence[Work]) -> Generator[Any, None, None]:
    """Do tasks in this process."""
    return (record for task in tasks for record in task.each())


def compile_first(task: TrialTask) -> None:
    """Do the beginning of one run in this process: else all workers would compile the same kernels at the same time."""
    with one_process():
        compile_listed()
        task.beginning().run()
