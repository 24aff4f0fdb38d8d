"""Tasks in several processes; the runs of each task are returned as soon as it is done."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager

from clean_swarm_env.siblings import call
from train.running.runs import RunRecord, Task


def each_done(tasks: Sequence[Task], workers: int) -> Generator[list[RunRecord], None, None]:
    """Yield the runs of each task when it is done, in any order, from up to `workers` processes.

    Closing the iterator, or an error in a task, ends the other tasks at once. A single worker is this process itself.
    """
    if min(workers, len(tasks)) <= 1:
        for task in tasks:
            yield task.run()
        return
    context = multiprocessing.get_context("spawn")  # a forked child would inherit threads of Numba and BLAS
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(
        min(workers, len(tasks)), mp_context=context, initializer=call, initargs=(__name__, "start_worker")
    )
    finished = False
    try:
        with _ctrl_c_ignored():  # the first tasks start the workers, which inherit this
            futures = [pool.submit(task.run) for task in tasks]
        for future in as_completed(futures):
            yield future.result()
        finished = True
    finally:
        if not finished:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in set(multiprocessing.active_children()) - others:
                child.terminate()
        pool.shutdown()


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


def start_worker() -> None:
    """Start a thread that ends this worker when its parent ends, because a killed parent cannot end its workers."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.join,), daemon=True).start()


def _end_with(wait_for_parent: Callable[[], None]) -> None:
    """End this process when the parent has ended."""
    wait_for_parent()
    os._exit(1)
