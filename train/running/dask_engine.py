"""The engine of a Dask cluster: its workers do tasks, and its scheduler gives the tasks of dead workers to others.

Dask is the only way beyond one machine, and dask-jobqueue the only way to schedulers of jobs.
"""

from __future__ import annotations

import os
import pickle
import platform
import re
import shutil
import sys
import threading
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from clean_swarm_env.config.types import ConfigurationError
from selector.documents.plain import short
from selector.documents.trust import current_permission, permitting
from selforg.plugins import import_named, named_plugins
from train.running.bits import own_bits
from train.running.engine import Round, WorkerLost
from train.running.runs import Work

CLUSTERS = {"slurm": "SLURMCluster", "pbs": "PBSCluster", "lsf": "LSFCluster", "sge": "SGECluster"}
"""Scheduler of jobs -> the class of dask-jobqueue that speaks to it."""
PLACE = re.compile(rf"tcp://.+:\d+|({'|'.join(CLUSTERS)}):([1-9]\d{{0,3}})")
"""Address of a scheduler of Dask, or a scheduler of jobs with their number."""
PACKAGES = {"distributed": "distributed", "dask_jobqueue": "dask-jobqueue"}
PATIENCE = 10.0
"""Time in which a scheduler has to answer [s]."""
SETTINGS = {
    "logging": {"distributed": "critical", "distributed.client": "critical"},
    "distributed.admin.tick.interval": "1s",  # it looks 50 times a second whether it is late; other settings stay
}
_one_task = threading.Lock()
"""Held by the task of this process: workers may have several threads, missions share memory of their process."""


class DaskEngine:
    """Workers of the Dask scheduler at `tcp://HOST:PORT`, or of up to N jobs that are started for `slurm:N`.

    A task comes back as a whole. The scheduler gives the task of a dead worker to another, three times as it is set.
    A worker on which missions end differently than here is refused at its first task.

    Raises:
        ConfigurationError: no such place, or a missing package.

    """

    def __init__(self, place: str) -> None:
        found = PLACE.fullmatch(place)
        if found is None:
            known = ", ".join(f"{name}:JOBS" for name in CLUSTERS)
            raise ConfigurationError(f"--on: expected tcp://HOST:PORT, {known}, got {short(place)}")
        for module, package in PACKAGES.items():
            if find_spec(module) is None:
                raise ConfigurationError(f"--on needs {package}, which is not installed: pip install '.[cluster]'")
        self._place, self._scheduler, self._jobs = place, found[1], int(found[2] or 0)

    @contextmanager
    def rounds(self) -> Iterator[Round]:
        """Yield a function that does tasks; see `Engine`."""
        import dask

        dask.config.set(SETTINGS)  # before the import of distributed, which reads this
        from distributed import Client

        try:
            cluster = job_cluster(self._scheduler, self._jobs) if self._scheduler else None
            client = Client(cluster or self._place, timeout=PATIENCE)
        except (OSError, ValueError, RuntimeError) as error:
            raise ConfigurationError(f"{self._place}: {' '.join(str(error).split())}") from error
        try:
            if cluster is None and not client.scheduler_info()["workers"]:
                print(f"{self._place}: no worker has come yet; waiting for the first", file=sys.stderr)
            yield partial(self._round, client)
        finally:
            client.close(timeout=1.0)
            if cluster is not None:
                cluster.close()

    def _round(self, client: Any, tasks: Sequence[Work]) -> Generator[Any, None, None]:  # noqa: ANN401  (no types)
        from distributed import as_completed

        def remote(directory: str, pickled: bytes) -> Any:  # noqa: ANN401
            from clean_swarm_env.siblings import call  # here: Dask ends a worker that cannot read a function

            return call("train.running.dask_engine", "do_task", directory, pickled)

        work = partial(client.submit, remote, os.getcwd(), pure=False)
        here = (own_bits(), named_plugins(), current_permission())
        given = {work(pickle.dumps((*here, pickle.dumps(task)))): task for task in tasks}
        try:
            for future in as_completed(given):
                yield from self._runs(future, given[future])
        finally:
            client.cancel(list(given), force=True)

    def _runs(self, future: Any, task: Work) -> list[Any]:  # noqa: ANN401
        """Return the runs of a task that came to its end."""
        from distributed import KilledWorker

        try:
            return list(future.result())
        except KilledWorker as error:
            raise WorkerLost(task, int(error.allowed_failures) + 1) from error
        except ModuleNotFoundError as error:
            raise ConfigurationError(
                f"{self._place}: a worker lacks {error.name}; expected the environment of this command"
            ) from error
        except (CancelledError, OSError) as error:
            if future.status == "error":  # the task's own
                raise
            raise ConfigurationError(
                f"{self._place}: the scheduler is gone; finished runs are kept, and --resume continues"
            ) from error


def job_cluster(scheduler: str, jobs: int) -> Any:  # noqa: ANN401
    """Return a scheduler of Dask in this process and up to `jobs` jobs with a worker each, as many as there are tasks.

    What a job asks for stands in the file of dask-jobqueue, ~/.config/dask/jobqueue.yaml. The first job is submitted
    here, so that one line says why it is refused: later refusals would only be in Dask's own log.
    """
    import dask_jobqueue
    from distributed.core import Status

    kind = getattr(dask_jobqueue, CLUSTERS[scheduler])
    submit = kind.job_cls.submit_command
    if shutil.which(submit) is None:
        raise ValueError(f"expected the command {submit} of {scheduler.upper()} on this machine")
    cluster = kind()
    cluster.worker_spec.update(cluster.new_worker_spec())
    try:
        cluster.sync(cluster._correct_state)
    except (RuntimeError, ValueError) as error:
        for job in cluster.workers.values():
            job.status = Status.failed  # closing expects that, where nothing was submitted
        cluster.close()
        raise ValueError(str(error).rpartition("stderr:\n")[2].strip() or error) from error
    cluster.adapt(minimum_jobs=1, maximum_jobs=jobs)
    return cluster


def do_task(directory: str, pickled: bytes) -> list[Any]:
    """Return the runs of a task that a worker does, in the directory and with the permission of the command.

    Raises:
        ConfigurationError: the worker has other files, or missions end differently on it.

    """
    if not Path(directory).is_dir():
        raise ConfigurationError(f"{directory}: not on a worker; expected the file system of the command")
    os.chdir(directory)
    bits, plugins, permission, task_pickled = pickle.loads(pickled)
    with _one_task, permitting(permission):
        if own_bits() != bits:
            raise ConfigurationError(
                f"missions end differently on the worker {platform.node()} than here; "
                "expected the sources and the versions of packages of this command"
            )
        import_named(plugins)  # before the task, whose classes they may have
        task: Work = pickle.loads(task_pickled)
        return list(task.each())
