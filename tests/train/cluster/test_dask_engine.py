"""Dask: equal results also where workers are killed; a scheduler that is dead or dies costs no finished run."""

import errno
import subprocess
import sys
from dataclasses import dataclass

import pytest

from clean_swarm_env.config.types import ConfigurationError
from tests.train.cluster.loopback import ENVIRONMENT, QUIET, evaluate, loopback_cluster, results
from tests.train.commands import finished, wait_for_runs
from tests.train.learning.trainings import written
from tests.train.waiting import until
from train.running import dask_engine
from train.running.dask_engine import DaskEngine

pytestmark = [pytest.mark.long, pytest.mark.extra]


@pytest.mark.skipif(sys.platform != "linux", reason="looks at processes")
def test_equal_results_with_a_killed_worker_and_a_killed_nanny(cluster, tmp_path):
    import psutil

    until(lambda: len(psutil.Process(cluster.nannies[0].pid).children(recursive=True)) > 1)
    done = evaluate(tmp_path, "--on", cluster.address, "--output", "cluster")
    wait_for_runs(done, tmp_path / "cluster", 1)
    here = [psutil.Process(one.pid) for one in (cluster.scheduler, *cluster.nannies)]
    here += [child for one in here for child in one.children(recursive=True)]
    listening = {c.laddr.ip for one in here for c in one.net_connections() if c.status == psutil.CONN_LISTEN}
    assert listening == {"127.0.0.1"}
    for worker in psutil.Process(cluster.nannies[0].pid).children(recursive=True):
        worker.kill()
    wait_for_runs(done, tmp_path / "cluster", 100)
    cluster.nannies[1].kill()
    _, err = done.communicate(timeout=240)
    assert done.returncode == 0, err
    assert evaluate(tmp_path, "--workers", "1", "--output", "local").wait(timeout=240) == 0
    assert results(tmp_path / "cluster") == results(tmp_path / "local")


@pytest.mark.parametrize(("learner", "seeds", "part"), [("es", (), ""), ("ppo", ("--seeds", "4-5"), "seed-5/")])
def test_a_training_comes_to_the_same_bits_elsewhere(cluster, tmp_path, learner, seeds, part):
    pytest.importorskip("stable_baselines3")
    config = written(tmp_path, learner)
    for name, more in (("here", ()), ("elsewhere", ("--on", cluster.address))):
        words = ("train", learner, "--config", str(config), "--output", str(tmp_path / name), *seeds, *more)
        program = "from train.cli import main; main()"
        subprocess.run([sys.executable, "-c", program, *words], cwd=tmp_path, env=ENVIRONMENT, check=True, **QUIET)
    for name in ("policy/policy.safetensors", "history.jsonl", *(() if part else ("checkpoint.json",))):
        here, elsewhere = (tmp_path / place / part / name for place in ("here", "elsewhere"))
        assert here.read_bytes() == elsewhere.read_bytes(), name


def test_a_scheduler_that_dies_costs_no_finished_run(cluster, tmp_path):
    done = evaluate(tmp_path, "--on", cluster.address, "--output", "cut")
    wait_for_runs(done, tmp_path / "cut", 1)
    cluster.scheduler.kill()
    _, err = done.communicate(timeout=240)
    assert done.returncode == 2
    error = f"error: {cluster.address}: the scheduler is gone; finished runs are kept, and --resume continues\n"
    assert error in err
    assert "Traceback" not in err
    assert 0 < finished(tmp_path / "cut") < 200
    assert evaluate(tmp_path, "--workers", "2", "--output", "cut", "--resume").wait(timeout=240) == 0
    assert finished(tmp_path / "cut") == 200


@dataclass(frozen=True)
class Refused:
    """A task whose files a worker may not write."""

    keys = (("1", "Off"),)

    def each(self):
        raise PermissionError(errno.EACCES, "Permission denied", "recordings")


def test_errors_of_a_task_and_of_a_worker_that_differs_are_not_taken_for_those_of_the_scheduler(cluster, monkeypatch):
    for here, error, expected in (
        (dask_engine.own_bits(), PermissionError, "Permission denied: 'recordings'"),
        ("0123", ConfigurationError, "missions end differently on the worker .* than here; expected the sources"),
    ):
        monkeypatch.setattr(dask_engine, "own_bits", lambda here=here: here)
        with DaskEngine(cluster.address).rounds() as done, pytest.raises(error, match=expected):
            list(done([Refused()]))


def test_a_cluster_without_the_project_is_one_line(cluster, tmp_path):
    from distributed import Client

    with Client(cluster.address) as client:
        client.wait_for_workers(2)
        for everywhere in (client.run, client.run_on_scheduler):
            everywhere(lambda: sys.modules.update(clean_swarm_env=None))
    done = evaluate(tmp_path, "--on", cluster.address, "--output", "none")
    _, err = done.communicate(timeout=240)
    assert done.returncode == 2
    assert f"error: {cluster.address}: a worker lacks clean_swarm_env" in err
    assert "Traceback" not in err


def test_who_waits_for_workers_is_told(tmp_path, capsys):
    pytest.importorskip("distributed", reason="Dask is not installed (extra `cluster`)")
    with loopback_cluster(tmp_path, workers=0) as alone, DaskEngine(alone.address).rounds():
        assert capsys.readouterr().err == f"{alone.address}: no worker has come yet; waiting for the first\n"
