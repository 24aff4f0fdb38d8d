"""Parts of kernels: compiled once for all callers, and plain functions for Python."""

import pickle
import subprocess
import sys

import numpy as np
import pytest
from numba.core import event
from numba.core.caching import NullCache

from selforg.compiler.decorators import inlined, kernel, lean_kernel, part
from selforg.compiler.switches import COMPILED, PLAIN
from selforg.elementary import fill_unit_vectors
from tests.paths import ROOT


class Listed(event.Listener):
    """The names of the functions that are compiled."""

    def __init__(self):
        self.names = []

    def on_start(self, event):
        self.names.append(event.data["dispatcher"].py_func.__name__)

    def on_end(self, event):
        pass


@part
def doubled(number):
    return 2 * number


@inlined
def increased(number):
    return doubled(number) + 1


@lean_kernel
def lean(numbers):
    return doubled(numbers[0]) + increased(1)


@kernel
def plain(numbers):
    return doubled(3) + increased(numbers[0])


@pytest.mark.skipif(PLAIN or not COMPILED, reason="Numba by itself compiles a part several times")
def test_a_part_is_compiled_once_for_all_kernels_constants_and_whole_numbers(monkeypatch):
    listed = Listed()
    for each in (lean, plain):
        monkeypatch.setattr(each, "_cache", NullCache())  # an earlier run has kept them
    with event.install_listener("numba:compile", listed):
        assert (lean.py_func(np.array([4])), plain.py_func(np.array([4]))) == (11, 15)
        for kind in (np.int32, np.int64):
            assert (lean(np.array([4], dtype=kind)), plain(np.array([4], dtype=kind))) == (11, 15)
    assert sorted(name for name in set(listed.names) if name in {"doubled", "increased"}) == ["doubled", "increased"]
    assert (listed.names.count("doubled"), listed.names.count("increased")) == (1, 1)


def test_python_runs_a_part_uncompiled():
    assert doubled("ab") == "abab"


@part
def checked(number):
    if number < 0:
        raise ValueError("expected a number from 0 up")
    return number


@kernel
def checking(number):
    return checked(number)


def test_an_error_in_a_part_reaches_the_caller():
    assert checking(1) == 1
    with pytest.raises(ValueError, match="expected a number from 0 up"):
        checking(-1)


PICKLED = """
import pickle, sys
import numpy as np
kernel, filled = pickle.loads(bytes.fromhex(sys.argv[1])), [np.zeros(2), np.zeros(2)]
kernel(np.zeros(2), *filled)
print(*filled)
"""


def test_a_kernel_can_be_pickled_for_another_process():
    words = [sys.executable, "-c", PICKLED, pickle.dumps(fill_unit_vectors).hex()]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    assert done.stdout == "[1. 1.] [0. 0.]\n", done.stderr
