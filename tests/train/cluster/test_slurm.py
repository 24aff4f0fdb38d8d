"""A real SLURM of two nodes: workers of Dask in its jobs, one of which is cancelled, and jobs that it refuses."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.paths import ROOT
from tests.train.cluster import slurm
from tests.train.cluster.loopback import results
from tests.train.commands import finished
from tests.train.waiting import until

pytestmark = [pytest.mark.long, pytest.mark.extra]
WORDS = ("-m", "tests.train.fake_mission", "evaluate", "--scenarios", "12")
ON_SLURM = ("--on", "slurm:2", "--output", "jobs")
JOBS = """
jobqueue:
  slurm:
    cores: 1
    memory: {memory}
    interface: lo
    local-directory: /tmp
    log-directory: {folder}/logs
    scheduler-options: {{dashboard_address: "127.0.0.1:0"}}
"""


@pytest.fixture(scope="module")
def cluster() -> Iterator[slurm.Slurm]:
    """SLURM on this machine."""
    pytest.importorskip("dask_jobqueue", reason="Dask is not installed (extra `cluster`)")
    why = slurm.missing()
    if why:
        pytest.skip(why)
    with slurm.running() as cluster:
        yield cluster


def environment(folder: Path, memory: str) -> dict[str, str]:
    """Return the environment of fake missions, whose jobs ask for so much memory."""
    (folder / "jobqueue.yaml").write_text(JOBS.format(folder=folder, memory=memory))
    return {"PYTHONPATH": str(ROOT), "FAKE_SECONDS": "0.4", "DASK_CONFIG": str(folder)}


def log(cluster: slurm.Slurm) -> str:
    """Return what commands in the network of SLURM have said."""
    return (cluster.home / f"{Path(sys.executable).name}.log").read_text()


def test_workers_in_jobs_give_what_one_command_gives_after_scancel(cluster, tmp_path):
    given = environment(tmp_path, "2GB")
    with cluster.start(sys.executable, *WORDS, *ON_SLURM, folder=tmp_path, **given) as process:
        until(lambda: finished(tmp_path / "jobs") >= 3 or process.poll() is not None)
        first = cluster.do("squeue", "--noheader", "--states=R", "--format=%i").split()[0]
        cluster.do("scancel", first)
        until(lambda: process.poll() is not None)
    assert process.returncode == 0, log(cluster)
    cluster.do(sys.executable, *WORDS, "--workers", "2", "--output", "whole", folder=tmp_path, **given)
    assert results(tmp_path / "jobs") == results(tmp_path / "whole")


def test_jobs_that_slurm_refuses_are_one_line(cluster, tmp_path):
    process = cluster.start(sys.executable, *WORDS, *ON_SLURM, folder=tmp_path, **environment(tmp_path, "2TB"))
    assert process.wait(timeout=120) == 2
    said = log(cluster).splitlines()[-1]
    assert said.startswith("error: slurm:2: ")
    assert said.endswith("Requested node configuration is not available")
