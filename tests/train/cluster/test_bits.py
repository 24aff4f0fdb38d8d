"""Fingerprints of how missions end: equal in any process, and a worker whose missions end differently does no task."""

import pickle
import subprocess
import sys

import pytest

from clean_swarm_env.config.types import ConfigurationError
from selector.documents.trust import current_permission
from tests.paths import ROOT
from tests.train.running.test_processes import Some
from train.running import dask_engine
from train.running.bits import course_digest, own_bits


def sent(bits: str) -> bytes:
    """Return a task as a command whose missions end with these bits sends it."""
    return pickle.dumps((bits, (), current_permission(), pickle.dumps(Some("a"))))


def test_a_fingerprint_is_of_how_missions_end():
    first = own_bits()
    own_bits.cache_clear()
    assert own_bits() == first
    assert course_digest("crowded") != course_digest("table1")


@pytest.mark.long
def test_another_process_has_the_same_fingerprint():
    code = "from train.running.bits import own_bits; print(own_bits())"
    printed = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    assert printed.split() == [own_bits()]


def test_a_worker_does_the_tasks_of_commands_with_its_bits_and_refuses_others_in_one_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(dask_engine, "own_bits", lambda: "0123")
    assert [run.key for run in dask_engine.do_task(str(tmp_path), sent("0123"))] == list(Some("a").keys)
    for directory, bits, expected in (
        (tmp_path, "4567", "missions end differently on the worker .* than here; expected the sources and"),
        (tmp_path / "none", "0123", r"none: not on a worker; expected the file system of the command"),
    ):
        with pytest.raises(ConfigurationError, match=expected) as refused:
            dask_engine.do_task(str(directory), sent(bits))
        assert "\n" not in str(refused.value)
