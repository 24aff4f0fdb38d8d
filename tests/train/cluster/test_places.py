"""Places that `--on` names: which there are, what is missing for one, and jobs of four schedulers."""

import json
import os
import re

import pytest

from clean_swarm_env.config.types import ConfigurationError
from tests.train.cluster.loopback import evaluate, results
from tests.train.commands import refused
from train.running import dask_engine
from train.running.dask_engine import CLUSTERS, DaskEngine

JOB = {"cores": 2, "memory": "3GB", "walltime": "01:30", "queue": "short", "interface": "lo"}
"""Settings of jobs, as docs/clusters.md shows them."""
ASKED = {
    "slurm": ("#SBATCH --cpus-per-task=2", "#SBATCH --mem=3G", "#SBATCH -t 01:30", "#SBATCH -p short"),
    "pbs": ("#PBS -l select=1:ncpus=2:mem=2862MB", "#PBS -l walltime=01:30", "#PBS -q short"),
    "lsf": ("#BSUB -n 2", "#BSUB -M 3000000", "#BSUB -W 01:30", "#BSUB -q short"),
    "sge": ("#$ -l h_rt=01:30", "#$ -q short"),
}
"""Scheduler -> what scripts of its jobs say then; SGE names cores and memory by resources of each cluster."""
SUBMIT = """#!/bin/sh
cat ${1:+"$1"} > "$0-$$.sh"
setsid sh "$0-$$.sh" > "$0-$$.log" 2>&1 < /dev/null &
echo "Job <$!> is submitted"
"""
"""In place of qsub and bsub: starts the job on this machine."""
CANCEL = '#!/bin/sh\nkill -- "-$1"\n'
REFUSE = "#!/bin/sh\necho 'no such queue:\n short' >&2\nexit 1\n"


@pytest.mark.parametrize("place", ["127.0.0.1:8786", "slurm", "slurm:0", "pbs:x", "condor:2", "tcp://x", "sge:12345"])
def test_another_place_is_one_line(place):
    known = "tcp://HOST:PORT, slurm:JOBS, pbs:JOBS, lsf:JOBS, sge:JOBS"
    with pytest.raises(ConfigurationError, match=f"^--on: expected {known}, got '{place}'$"):
        DaskEngine(place)


def test_missions_that_learn_in_turn_stay_here():
    line = refused("evaluate", "--store", "s", "--learn", "--workers", 1, "--on", "pbs:1")
    assert line == "error: --on: expected no --learn, where missions learn in turn\n"


@pytest.mark.parametrize("place", ["tcp://10.0.0.1:8786", "slurm:1", "pbs:20", "lsf:300", "sge:9999"])
@pytest.mark.parametrize("module", ["distributed", "dask_jobqueue"])
def test_a_missing_package_is_one_line(place, module, monkeypatch):
    monkeypatch.setattr(dask_engine, "find_spec", lambda name: None if name == module else "there")
    package = module.replace("_", "-")
    with pytest.raises(ConfigurationError, match=f"^--on needs {package}, which is not installed: pip install"):
        DaskEngine(place)


@pytest.mark.extra
def test_a_scheduler_that_is_not_there_is_one_line(monkeypatch, tmp_path):
    pytest.importorskip("dask_jobqueue", reason="Dask is not installed (extra `cluster`)")
    monkeypatch.setattr(dask_engine, "PATIENCE", 0.5)
    monkeypatch.setenv("PATH", str(tmp_path))
    commands = {"slurm": "sbatch", "pbs": "qsub", "lsf": "bsub", "sge": "qsub"}
    expected = {f"{name}:2": f"expected the command {one} of {name.upper()}" for name, one in commands.items()}
    for place, what in (expected | {"tcp://127.0.0.1:1": "Timed out"}).items():
        with pytest.raises(ConfigurationError, match=f"^{place}: {what}") as refused, DaskEngine(place).rounds():
            pass
        assert "\n" not in str(refused.value)


@pytest.mark.extra
@pytest.mark.parametrize("scheduler", CLUSTERS)
def test_the_script_of_a_job_asks_for_what_the_settings_say(scheduler):
    dask = pytest.importorskip("dask", reason="Dask is not installed (extra `cluster`)")
    jobqueue = pytest.importorskip("dask_jobqueue")
    with dask.config.set({f"jobqueue.{scheduler}.{name}": value for name, value in JOB.items()}):
        script = getattr(jobqueue, CLUSTERS[scheduler]).job_cls("tcp://127.0.0.1:1", "a worker").job_script()
    assert not set(ASKED[scheduler]) - set(script.splitlines()), script
    assert re.search(
        r"-m distributed\.cli\.dask_worker tcp://127\.0\.0\.1:1 .*--nthreads 1 .*--nworkers 2 .*--interface lo", script
    )


@pytest.fixture
def commands(tmp_path):
    """Write the commands of schedulers into a folder, and settings; return the environment in which they are found."""
    pytest.importorskip("dask_jobqueue", reason="Dask is not installed (extra `cluster`)")

    def written(submit: str) -> dict[str, str]:
        for name in ("qsub", "bsub", "qdel", "bkill"):
            (tmp_path / name).write_text(submit if name.endswith("sub") else CANCEL)
            (tmp_path / name).chmod(0o755)
        job = {"cores": 1, "memory": "2GB", "interface": "lo", "local-directory": str(tmp_path)}
        job["scheduler-options"] = {"dashboard_address": "127.0.0.1:0"}
        (tmp_path / "jobqueue.yaml").write_text(json.dumps({"jobqueue": dict.fromkeys(CLUSTERS, job)}))
        return {"PATH": f"{tmp_path}:{os.environ['PATH']}", "DASK_CONFIG": str(tmp_path), "FAKE_SECONDS": "0.1"}

    return written


@pytest.mark.long
@pytest.mark.extra
@pytest.mark.parametrize("scheduler", ["pbs", "lsf", "sge"])
def test_jobs_of_other_schedulers_give_what_one_command_gives(scheduler, commands, tmp_path):
    few, environment = ("--scenarios", "4"), commands(SUBMIT)
    done = evaluate(tmp_path, *few, "--on", f"{scheduler}:2", "--output", "jobs", **environment)
    _, err = done.communicate(timeout=240)
    assert done.returncode == 0, err
    assert 1 <= len(list(tmp_path.glob("?sub-*.sh"))) <= 2
    assert evaluate(tmp_path, *few, "--workers", "1", "--output", "local", **environment).wait(timeout=240) == 0
    assert results(tmp_path / "jobs") == results(tmp_path / "local")


@pytest.mark.long
@pytest.mark.extra
@pytest.mark.parametrize(("scheduler", "why"), [("pbs", "no such queue: short"), ("lsf", "Command exited .*: bsub.*")])
def test_a_job_that_is_refused_is_one_line(scheduler, why, commands, tmp_path):
    done = evaluate(tmp_path, "--on", f"{scheduler}:2", "--output", "jobs", **commands(REFUSE))
    _, err = done.communicate(timeout=240)
    assert done.returncode == 2
    assert re.fullmatch(f"error: {scheduler}:2: {why}", err.splitlines()[-1]), err
    assert "Traceback" not in err
