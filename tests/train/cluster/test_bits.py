"""Fingerprints of what CPUs make of missions: equal in any process, and one that differs is refused and not noted."""

import json
import subprocess
import sys

import pytest

from clean_swarm_env.config.types import ConfigurationError
from tests.paths import ROOT
from train.running.bits import WorkerBits, noted_bits, own_bits


def test_another_process_has_the_same_fingerprint():
    code = "from train.running.bits import own_bits; print(*own_bits())"
    printed = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    assert printed.split() == list(own_bits())


def test_a_machine_that_differs_is_refused_and_not_noted():
    bits = WorkerBits()
    bits.add({"a": "one CPU"})
    bits.add({"a": "one more of this kind"})
    with pytest.raises(ConfigurationError, match=r"^other CPU: missions end differently than on one more of"):
        bits.add({"b": "other CPU"})
    assert list(bits.cpus) == ["a"]
    mixed = WorkerBits(mixed=True)
    mixed.add({"a": "one CPU"})
    mixed.add({"b": "other CPU"})
    assert list(mixed.cpus) == ["a", "b"]


def test_damaged_notes_are_one_line(tmp_path):
    (tmp_path / "manifest.json").write_text(json.dumps({"identity": {}, "workers": [1]}))
    with pytest.raises(ConfigurationError, match=r"manifest.json: workers: expected fingerprints with CPUs, got \[1\]"):
        noted_bits(tmp_path)
