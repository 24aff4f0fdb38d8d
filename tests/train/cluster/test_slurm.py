"""A real SLURM of two nodes: job arrays of shares, and workers of Dask in jobs; jobs are cancelled and killed."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.paths import ROOT
from tests.train.cluster import slurm
from tests.train.cluster.test_dask_engine import journal, rows

WORDS = ("evaluate", "--scenarios", "12")
JOBS = """
jobqueue:
  slurm:
    cores: 1
    memory: 2GB
    interface: lo
    local-directory: /tmp
    log-directory: {folder}/logs
    scheduler-options: {{dashboard_address: "127.0.0.1:0"}}
"""


@pytest.fixture(scope="module")
def cluster() -> Iterator[slurm.Slurm]:
    """SLURM on this machine."""
    why = slurm.missing()
    if why:
        pytest.skip(why)
    with slurm.running() as cluster:
        yield cluster


@pytest.fixture
def given(tmp_path) -> dict[str, str]:
    """The environment of fake missions."""
    (tmp_path / "jobqueue.yaml").write_text(JOBS.format(folder=tmp_path))
    return {"PYTHONPATH": str(ROOT), "FAKE_SECONDS": "0.4", "DASK_CONFIG": str(tmp_path)}


def fake(cluster: slurm.Slurm, folder: Path, *words: str, **given: str) -> str:
    return cluster.do(sys.executable, "-m", "tests.train.fake_mission", *words, folder=folder, **given)


def states(cluster: slurm.Slurm) -> list[str]:
    return cluster.do("squeue", "--noheader", "--array", "--states=all", "--format=%t").split()


def kill(folder: Path, words: bytes) -> None:
    """Kill what runs in the folder with these words: other tests may use the same words at the same time."""
    killed = 0
    for entry in Path("/proc").iterdir():
        with suppress(FileNotFoundError, ProcessLookupError):  # it has ended since
            if (
                entry.name.isdecimal()
                and words in (entry / "cmdline").read_bytes()
                and (entry / "cwd").samefile(folder)
            ):
                os.kill(int(entry.name), signal.SIGKILL)
                killed += 1
    assert killed


def test_a_job_array_gives_what_one_command_gives_after_scancel_and_kill(cluster, tmp_path, given):
    printed = fake(cluster, tmp_path, "machine", "slurm", "--shares", "3", *WORDS, "--output", "array", **given)
    (tmp_path / "array.sh").write_text(printed.replace("-m clean_swarm_env", "-m tests.train.fake_mission"))
    job = cluster.do("sbatch", "--parsable", "array.sh", folder=tmp_path, **given).strip()
    shares = [tmp_path / "array" / "shares" / f"{number}-of-3" for number in (1, 2)]
    cluster.wait(lambda: all(journal(share) >= 2 for share in shares))
    cluster.do("scancel", f"{job}_1")
    kill(tmp_path, b"--share\x002/3")
    cluster.wait(lambda: sorted(states(cluster)) == ["CA", "CD", "F"])
    assert all(2 <= journal(share) < 8 for share in shares)
    cluster.do("sbatch", "array.sh", folder=tmp_path, **given)
    cluster.wait(lambda: states(cluster).count("CD") == 4)
    fake(cluster, tmp_path, "gather", "array", **given)
    fake(cluster, tmp_path, *WORDS, "--workers", "2", "--output", "whole", **given)
    assert rows(tmp_path / "array") == rows(tmp_path / "whole")


@pytest.mark.skipif(find_spec("dask_jobqueue") is None, reason="Dask is not installed (extra `cluster`)")
def test_workers_in_jobs_give_what_one_command_gives_after_scancel(cluster, tmp_path, given):
    words = ("-m", "tests.train.fake_mission", *WORDS, "--on", "slurm:2", "--output", "jobs")
    with cluster.start(sys.executable, *words, folder=tmp_path, **given) as process:
        cluster.wait(lambda: journal(tmp_path / "jobs") >= 3 or process.poll() is not None)
        first = cluster.do("squeue", "--noheader", "--states=R", "--format=%i").split()[0]
        cluster.do("scancel", first)
        cluster.wait(lambda: process.poll() is not None)
    assert process.returncode == 0, (cluster.home / f"{Path(sys.executable).name}.log").read_text()
    fake(cluster, tmp_path, *WORDS, "--workers", "2", "--output", "whole", **given)
    assert rows(tmp_path / "jobs") == rows(tmp_path / "whole")


@pytest.mark.skipif(find_spec("dask_jobqueue") is None, reason="Dask is not installed (extra `cluster`)")
def test_jobs_that_slurm_refuses_are_one_line(cluster, tmp_path, given):
    (tmp_path / "jobqueue.yaml").write_text(JOBS.format(folder=tmp_path).replace("2GB", "2TB"))
    words = ("-m", "tests.train.fake_mission", *WORDS, "--on", "slurm:2", "--output", "jobs")
    process = cluster.start(sys.executable, *words, folder=tmp_path, **given)
    assert process.wait(timeout=60) == 2
    *_, last = (cluster.home / f"{Path(sys.executable).name}.log").read_text().splitlines()
    assert last == "error: slurm:2: allocation failure: Requested node configuration is not available"
