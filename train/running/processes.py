"""Tasks in processes of this machine; each run is returned as soon as it is done, also where its task goes on.

Why not a pool or a queue of the standard library: docs/decisions/0068-runs-from-workers.md.
"""

import multiprocessing
import os
import pickle
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from traceback import format_exc
from typing import Any

from clean_swarm_env.siblings import call
from selector.documents.trust import Permission, current_permission, permitting
from train.running import ENDING
from train.running.engine import MOST_DEATHS, Round, WorkerLost, in_turn
from train.running.pulse import listening, tell
from train.running.runs import RunKey, Work

_HELD = [getattr(signal, name) for name in (*ENDING, "SIGALRM") if hasattr(signal, name)]
"""Signals that end a command; SIGALRM does if another one had to wait."""


@dataclass
class _Attempt:
    """A task that a worker does or has to do."""

    task: Work
    deaths: int = 0
    """Workers that died of it."""
    done: set[RunKey] = field(default_factory=set)

    def again(self) -> "_Attempt | None":
        """Return the attempt at the task's missing runs after its worker has died; None if it lacks nothing."""
        if self.done.issuperset(self.task.keys):
            return None
        if self.deaths + 1 == MOST_DEATHS:
            raise WorkerLost(self.task)
        return _Attempt(self.task.without(self.done), self.deaths + 1)


class Processes:
    """The engine of this machine: up to `most` processes that get tasks and send back their runs.

    Each has a pipe of its own: a kill breaks no other's. A single process, or a single task in the first round, is done
    by this process itself. A process that dies is replaced, and what its task lacks is run again.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._processes: dict[Connection, BaseProcess] = {}
        self._busy: dict[Connection, _Attempt] = {}

    @contextmanager
    def rounds(self) -> Iterator[Round]:
        """Yield a function that does tasks; see `Engine`. Then end the processes, and tasks that are not done."""
        try:
            yield self._round
        finally:
            for connection, process in self._processes.items():
                if connection in self._busy:
                    process.terminate()
                connection.close()
            for process in self._processes.values():
                process.join()

    def _round(self, tasks: Sequence[Work]) -> Generator[Any, None, None]:
        """Do the tasks and yield their runs, also those that are done when it is interrupted or a task is given up."""
        if min(self._most, len(tasks)) <= 1 and not self._processes:
            yield from in_turn(tasks)
            return
        try:
            yield from self._done(deque(map(_Attempt, tasks)))
        except (WorkerLost, KeyboardInterrupt):
            yield from self._sent()
            raise

    def _done(self, waiting: deque[_Attempt]) -> Iterator[Any]:
        while waiting or self._busy:
            self._give(waiting)
            ready = wait(self._busy)
            for connection in [one for one in self._busy if one in ready]:
                try:
                    answer = connection.recv()
                except (EOFError, OSError):  # the process is dead
                    self._processes.pop(connection).join()
                    connection.close()
                    again = self._busy.pop(connection).again()
                    waiting.extendleft([again] if again else [])
                    continue
                if isinstance(answer, Exception):
                    raise answer
                if isinstance(answer, float):
                    tell(answer)
                elif answer is None:
                    del self._busy[connection]
                else:
                    self._busy[connection].done.add(answer.key)
                    yield answer

    def _give(self, waiting: deque[_Attempt]) -> None:
        """Give tasks to idle processes, and start more where there are too few."""
        idle = [connection for connection in self._processes if connection not in self._busy]
        while waiting and len(self._busy) < self._most:
            connection = idle.pop() if idle else self._started()
            self._busy[connection] = waiting.popleft()
            with suppress(OSError):  # the worker is dead, which the next reading from the pipe notices
                connection.send(self._busy[connection].task)

    def _started(self) -> Connection:
        context = multiprocessing.get_context("spawn")  # a forked child would inherit threads of Numba and BLAS
        ours, theirs = context.Pipe()
        process = context.Process(target=call, args=(__name__, "work", theirs, current_permission()))
        with _ctrl_c_held():
            process.start()
            theirs.close()  # now its end is the worker's alone, and closed when that ends
            self._processes[ours] = process
        return ours

    def _sent(self) -> Iterator[Any]:
        """End the tasks, and yield the runs that were done but not yet received."""
        for connection in self._busy:
            self._processes[connection].terminate()
            self._processes[connection].join()
            with suppress(EOFError, OSError):
                while connection.poll():
                    answer = connection.recv()
                    if hasattr(answer, "key"):
                        yield answer


@contextmanager
def _ctrl_c_held() -> Iterator[None]:
    """Hold signals that end a command back until the end: a process that starts would read half of what it gets.

    Ctrl-C is held back from processes that start here, too: a terminal sends it to them as well.
    """
    if threading.current_thread() is not threading.main_thread() or os.name != "posix":  # only it may change signals
        yield
        return
    came: list[int] = []
    before = {number: signal.signal(number, lambda own, _: came.append(own)) for number in _HELD}
    resource_tracker.ensure_running()  # its start lets signals through
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # which the process inherits
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came:
            signal.raise_signal(number)


def work(connection: Connection, permission: Permission) -> None:
    """Do the tasks that come over a pipe: send each run when it is done, None after a task, or the error of a task.

    The worker has the permission of its parent. A thread ends it when its parent ends, because a killed parent cannot
    end its workers.
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.join,), daemon=True).start()
    with permitting(permission), suppress(EOFError, OSError):  # the parent closes the pipe after the last task
        while True:
            packed = connection.recv_bytes()
            try:  # reading a task may import plug-ins, which fail
                task: Work = pickle.loads(packed)
                with listening(connection.send):
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
