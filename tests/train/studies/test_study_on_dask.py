"""Studies on Dask: the same trials and knowledge as on this machine, also where a worker is killed."""

import os
import signal
from dataclasses import dataclass
from pathlib import Path

import pytest

pytest.importorskip("optuna", reason="optuna is not installed (extra tune)")
pytest.importorskip("ribs", reason="pyribs is not installed (extra tune)")

from tests.train.studies.synthetic import SyntheticTask, synthetic
from tests.train.studies.test_study import contents, request_of, studied
from train.running.commands import FINISHED
from train.running.needs import Machine


@dataclass(frozen=True)
class Deadly(SyntheticTask):
    """A task that kills its worker, once."""

    mark: str = ""

    def each(self):
        if not Path(self.mark).exists():
            Path(self.mark).touch()
            os.kill(os.getpid(), signal.SIGKILL)
        yield from super().each()


def test_a_study_whose_worker_is_killed_comes_to_the_same(configs, cluster, tmp_path):
    assert studied(request_of(configs, tmp_path / "here"), synthetic) == FINISHED

    def deadly(stage, candidate, numbers):
        task = synthetic(stage, candidate, numbers)
        return (
            Deadly(stage, task.name, task.excess, numbers, mark=str(tmp_path / "killed"))
            if candidate.name == "TPE-9"
            else task
        )

    request = request_of(configs, tmp_path / "there", machine=Machine(place=cluster.address))
    assert studied(request, deadly) == FINISHED
    assert (tmp_path / "killed").exists()
    assert contents(tmp_path / "there") == contents(tmp_path / "here")
