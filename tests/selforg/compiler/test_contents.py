"""The key of a kernel changes with all that it is compiled from, and with nothing else."""

import copy
from ctypes import CFUNCTYPE, c_double
from enum import Enum
from importlib import import_module
from types import ModuleType

import numpy as np
import pytest
from numba import types
from numba.extending import overload

from clean_swarm_env.config.task_names import TASKS_HOME
from selforg.compiler import contents
from selforg.compiler.decorators import KERNELS

INNER = """
from selforg.compiler.decorators import inlined, part
from typing import NamedTuple
class Pair(NamedTuple):
    x: float
    y: float
LIMIT, TABLE = 100.0, (1, 2.0)
def scaled(scale):
    @part
    def product(x): return scale * x
    return product
double = scaled(2.0)
@part
def inner(x): return double(x) + LIMIT
"""
OUTER = """
from inner import *
import inner as module
import numpy as np
def outer(x, y=1.0):
    pair = Pair(x, y)
    # a remark
    return inner(pair.x) + np.sin(x) + module.TABLE[1]
"""
CHANGES = {
    "a constant of another file": ("LIMIT, TABLE = 100.0", "LIMIT, TABLE = 200.0"),
    "its kind": ("LIMIT, TABLE = 100.0", "LIMIT, TABLE = 100"),
    "one that is read by its module": ("(1, 2.0)", "(1, 3.0)"),
    "a part of another file": ("double(x) + LIMIT", "double(x) - LIMIT"),
    "a closure": ("scaled(2.0)", "scaled(4.0)"),
    "how a part is compiled": ("@part\ndef inner", "@inlined\ndef inner"),
    "fields": ("    x: float\n    y: float", "    y: float\n    x: float"),
    "the kernel": ("+ np.sin(x)", "- np.sin(x)"),
    "what it calls by name": ("np.sin(x)", "np.cos(x)"),
    "a default": ("y=1.0", "y=2.0"),
}
NO_CHANGES = {
    "nothing": ("", ""),
    "a remark": ("# a remark", "# another\n    # remark"),
    "what is not read": ("LIMIT, TABLE", "OTHER, LIMIT, TABLE = 7.0, 1.0, 1.0\nLIMIT, TABLE"),
}


def module_of(name, code):
    module = ModuleType(name)
    exec(compile(code, f"/nowhere/{name}.py", "exec"), module.__dict__)
    return module


@pytest.fixture
def key_after(monkeypatch):
    """Return the key of the kernel after a change, by names of modules that are its own."""

    def key(old, new):
        inner = module_of("inner", INNER.replace(old, new, 1))
        monkeypatch.setitem(contents.sys.modules, "inner", inner)
        return contents.content_key(module_of("outer", OUTER.replace(old, new, 1)).outer)

    return key


@pytest.mark.parametrize("change", CHANGES)
def test_the_key_changes_with(change, key_after):
    assert key_after(*CHANGES[change]) != key_after("", "")


@pytest.mark.parametrize("change", NO_CHANGES)
def test_the_key_does_not_change_with(change, key_after):
    assert key_after(*NO_CHANGES[change]) == key_after("", "")


class Colour(Enum):
    RED = 1


class Thing:
    pass


def reading(value):
    """Return a function that reads a value."""
    return lambda x: value


@pytest.mark.parametrize(
    ("value", "other"),
    [
        (np.array([1.0, 2.0]), np.array([1.0, 3.0])),
        (np.zeros((2, 3)), np.zeros((3, 2))),
        (np.float32(1.0), np.float64(1.0)),
        (True, 1),
        (0.0, -0.0),
        ({"a": {1, 2}}, {"a": {1, 3}}),
        ([None], [Colour.RED]),
        (ValueError, TypeError),
        (Colour, ValueError),
        (types.float64[:], types.float64[::1]),
    ],
)
def test_the_key_changes_with_a_value(value, other):
    assert contents.content_key(reading(value)) == contents.content_key(reading(copy.deepcopy(value)))
    assert contents.content_key(reading(value)) != contents.content_key(reading(other))


def test_the_key_changes_with_what_is_overloaded():
    def overloaded(number):
        def called(x):
            return x

        overload(called)(lambda x: lambda x: x + number)
        return contents.content_key(reading(called))

    assert overloaded(1.0) == overloaded(1.0) != overloaded(2.0)


@pytest.mark.parametrize("value", [object(), CFUNCTYPE(c_double)(lambda: 1.0), np.array([object()]), Thing, Thing()])
def test_what_is_another_thing_in_each_process_has_no_key(value):
    with pytest.raises(contents.UnkeyedError, match=r"test_contents.py:\d+: <lambda> reads "):
        contents.content_key(reading(value))


def test_what_names_itself_has_a_key():
    first, second = ModuleType("first"), ModuleType("second")
    first.second, second.first, second.number = second, first, 1.0

    def again(x):
        return again(x - first.second.number) if x > 0.0 else second.first.second.number

    before = contents.words_of_function.__wrapped__(again)
    second.number = 2.0
    assert contents.words_of_function.__wrapped__(again) != before


def test_each_kernel_of_ours_can_be_kept_wherever_python_and_its_packages_lie():
    import_module(TASKS_HOME)
    kernels = [getattr(kernel, "py_func", kernel) for kernel in KERNELS.values()]
    assert len(set(map(contents.content_key, kernels))) > 80
    assert not [one for one in kernels if "/numpy/" in contents.words_of_function(one)[0]]
