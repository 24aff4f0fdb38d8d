"""Tasks in several processes; each run is returned as soon as it is done, also where its task goes on."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection, wait
from traceback import format_exc
from typing import Protocol

from clean_swarm_env.siblings import call
from train.running.runs import RunRecord


class Work(Protocol):
    """Runs that one process does; plain data, which can be sent to a worker process."""

    def each(self) -> Iterator[RunRecord]:
        """Do the runs, and yield each when it is done."""


Round = Callable[[Sequence[Work]], Iterator[RunRecord]]
"""A function that does tasks, and yields each run when it is done."""


def each_done(tasks: Sequence[Work], workers: int) -> Generator[RunRecord, None, None]:
    """Yield each run when it is done, in any order, from up to `workers` processes.

    Closing the iterator, or an error in a task, ends the other tasks at once. A single worker is this process itself.

    Raises:
        BrokenProcessPool: a worker was killed; all runs that were done have been yielded.

    """
    with rounds(min(workers, len(tasks))) as done:
        yield from done(tasks)


@contextmanager
def rounds(workers: int) -> Iterator[Round]:
    """Yield a function that does some tasks as `each_done` does, in processes that stay for the tasks after them."""
    if workers <= 1:
        yield in_turn
        return
    pool = _Workers()
    try:
        with _ctrl_c_ignored():  # workers inherit this
            pool.start(workers)
        yield pool.round
    finally:
        pool.end()


def in_turn(tasks: Sequence[Work]) -> Iterator[RunRecord]:
    """Do tasks in this process."""
    return (record for task in tasks for record in task.each())


class _Workers:
    """Processes that get tasks and send back their runs, each over a pipe of its own: a kill breaks no other's."""

    def __init__(self) -> None:
        self._processes: dict[Connection, multiprocessing.process.BaseProcess] = {}
        self._busy: set[Connection] = set()

    def start(self, count: int) -> None:
        """Start processes."""
        context = multiprocessing.get_context("spawn")  # a forked child would inherit threads of Numba and BLAS
        for _ in range(count):
            ours, theirs = context.Pipe()
            process = context.Process(target=call, args=(__name__, "work", theirs))
            process.start()
            theirs.close()  # now its end is the worker's alone, and closed when that ends
            self._processes[ours] = process

    def round(self, tasks: Sequence[Work]) -> Iterator[RunRecord]:
        """Do the tasks and yield their runs, also those that are done when it is interrupted or a worker is killed."""
        try:
            yield from self._done(iter(tasks))
        except (BrokenProcessPool, KeyboardInterrupt):
            yield from self._sent()
            raise

    def _done(self, tasks: Iterator[Work]) -> Iterator[RunRecord]:
        self._busy.update(self._processes)
        for connection in self._processes:
            self._give(connection, tasks)
        while self._busy:
            ready = wait(self._busy)
            for connection in [one for one in self._busy if one in ready]:
                with _killed_worker():
                    answer = connection.recv()
                if isinstance(answer, Exception):
                    raise answer
                if answer is None:
                    self._give(connection, tasks)
                else:
                    yield answer

    def _sent(self) -> Iterator[RunRecord]:
        """End the tasks, and yield the runs that were done but not yet received."""
        for connection in self._busy:
            self._processes[connection].terminate()
            self._processes[connection].join()
            with suppress(EOFError, OSError):
                while connection.poll():
                    answer = connection.recv()
                    if answer is not None and not isinstance(answer, Exception):
                        yield answer

    def end(self) -> None:
        """End the processes, and the tasks that are not done."""
        for connection, process in self._processes.items():
            if connection in self._busy:
                process.terminate()
            connection.close()
        for process in self._processes.values():
            process.join()

    def _give(self, connection: Connection, tasks: Iterator[Work]) -> None:
        task = next(tasks, None)
        if task is None:
            self._busy.discard(connection)
            return
        with _killed_worker():
            connection.send(task)


@contextmanager
def _killed_worker() -> Iterator[None]:
    """Turn the end of a pipe into BrokenProcessPool."""
    try:
        yield
    except (EOFError, OSError) as error:
        raise BrokenProcessPool("a worker process was killed") from error


@contextmanager
def _ctrl_c_ignored() -> Iterator[None]:
    """Ignore Ctrl-C: a terminal sends it to the workers too, but the parent ends its workers."""
    if threading.current_thread() is not threading.main_thread():  # only the main thread may change signals
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def work(connection: Connection) -> None:
    """Do the tasks that come over a pipe: send each run when it is done, None after a task, or the error of a task.

    A thread ends this worker when its parent ends, because a killed parent cannot end its workers.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.join,), daemon=True).start()
    with suppress(EOFError, OSError):  # the parent closed the pipe: there are no more tasks
        while True:
            task: Work = connection.recv()
            try:
                for record in task.each():
                    connection.send(record)
                connection.send(None)
            except Exception as error:
                error.add_note(format_exc())
                connection.send(error)


def _end_with(wait_for_parent: Callable[[], None]) -> None:
    """End this process when the parent has ended."""
    wait_for_parent()
    os._exit(1)
