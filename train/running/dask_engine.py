"""The engine of a Dask cluster: its workers do tasks, and its scheduler gives the tasks of dead workers to others."""

from __future__ import annotations

import os
import pickle
import re
import shutil
import subprocess
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
from train.running.bits import WorkerBits, own_bits
from train.running.engine import Round, WorkerLost
from train.running.runs import RunRecord, Work

PLACE = re.compile(r"(tcp://.+:\d+)|slurm:([1-9]\d{0,3})")
"""Address of a scheduler, or a number of jobs."""
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

    Raises:
        ConfigurationError: no such place, or a missing package.

    """

    def __init__(self, place: str, bits: WorkerBits) -> None:
        found = PLACE.fullmatch(place)
        if found is None:
            raise ConfigurationError(f"--on: expected tcp://HOST:PORT or slurm:JOBS, got {short(place)}")
        for module, package in PACKAGES.items():
            if find_spec(module) is None:
                raise ConfigurationError(f"--on needs {package}, which is not installed: pip install '.[cluster]'")
        self._place, self._jobs, self._bits = place, int(found[2] or 0), bits

    @contextmanager
    def rounds(self) -> Iterator[Round]:
        """Yield a function that does tasks; see `Engine`."""
        import dask

        dask.config.set(SETTINGS)  # before the import of distributed, which reads this
        from distributed import Client

        try:
            cluster = slurm_cluster(self._jobs) if self._jobs else None
            client = Client(cluster or self._place, timeout=PATIENCE)
        except (OSError, ValueError) as error:
            raise ConfigurationError(f"{self._place}: {' '.join(str(error).split())}") from error
        try:
            if cluster is None and not client.scheduler_info()["workers"]:
                print(f"{self._place}: no worker has come yet; waiting for the first", file=sys.stderr)
            yield partial(self._round, client)
        finally:
            client.close(timeout=1.0)
            if cluster is not None:
                cluster.close()

    def _round(self, client: Any, tasks: Sequence[Work]) -> Generator[RunRecord, None, None]:  # noqa: ANN401  (no types)
        from distributed import as_completed

        def remote(directory: str, pickled: bytes) -> Any:  # noqa: ANN401
            from clean_swarm_env.siblings import call  # here: Dask ends a worker that cannot read a function

            return call("train.running.dask_engine", "do_task", directory, pickled)

        work = partial(client.submit, remote, os.getcwd(), pure=False)
        given = {
            work(pickle.dumps((named_plugins(), current_permission(), pickle.dumps(task)))): task for task in tasks
        }
        try:
            for future in as_completed(given):
                yield from self._runs(future, given[future])
        finally:
            client.cancel(list(given), force=True)

    def _runs(self, future: Any, task: Work) -> list[RunRecord]:  # noqa: ANN401
        """Return the runs of a task that came to its end."""
        from distributed import KilledWorker

        try:
            cpus, runs = future.result()
        except KilledWorker as error:
            raise WorkerLost(task, int(error.allowed_failures) + 1) from error
        except ModuleNotFoundError as error:
            expected = "expected the environment of this command"
            raise ConfigurationError(f"{self._place}: a worker lacks {error.name}; {expected}") from error
        except (CancelledError, OSError) as error:
            if future.status == "error":  # the task's own
                raise
            kept = "finished runs are kept, and --resume continues"
            raise ConfigurationError(f"{self._place}: the scheduler is gone; {kept}") from error
        self._bits.add(cpus)
        done: list[RunRecord] = runs
        return done


def slurm_cluster(jobs: int) -> Any:  # noqa: ANN401
    """Return a scheduler in this process and up to `jobs` jobs of SLURM, as many as there are tasks.

    What a job asks for stands in the file of dask-jobqueue: ~/.config/dask/jobqueue.yaml.
    """
    from dask_jobqueue import SLURMCluster

    if shutil.which("sbatch") is None:
        raise ValueError("expected the command sbatch of SLURM on this machine")
    cluster = SLURMCluster()
    tested = subprocess.run(["sbatch", "--test-only"], input=cluster.job_script(), text=True, capture_output=True)
    if tested.returncode != 0:
        cluster.close()
        raise ValueError(tested.stderr)
    cluster.adapt(minimum_jobs=1, maximum_jobs=jobs)
    return cluster


def do_task(directory: str, pickled: bytes) -> tuple[dict[str, str], list[RunRecord]]:
    """Do a task in a worker, in the directory and with the permission of the command.

    Return the fingerprint of the worker, and the runs.
    """
    if not Path(directory).is_dir():
        raise ConfigurationError(f"{directory}: not on a worker; expected the file system of the command")
    os.chdir(directory)
    plugins, permission, task_pickled = pickle.loads(pickled)
    with _one_task, permitting(permission):
        import_named(plugins)  # before the task, whose classes they may have
        task: Work = pickle.loads(task_pickled)
        return own_bits(), list(task.each())
