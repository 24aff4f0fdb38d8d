"""What a kernel is compiled from, as a hash, under which its compiled code is kept.

It covers the byte code of the kernel and of all functions that are compiled into it, wherever these lie, the values of
the globals and closures that they read, the compiler and the CPU. It does not depend on where files lie, on the names
by which they were imported, or on lines and comments (docs/decisions/0050-kernel-cache.md).
"""

import hashlib
import sys
from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from functools import cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import llvmlite
import numba
import numpy as np
from llvmlite import binding
from numba import types
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic
from numba.core.typing.templates import builtin_registry

from selforg.compiler.intrinsics import Compiler, Opened
from selforg.compiler.switches import CHECKED, PLAIN

VERSIONED = sys.stdlib_module_names | {"numba", "numpy", "llvmlite"}
"""Packages of which a name is enough, since their versions are in every key."""
DECIDING = ("OPT", "ENABLE_AVX", "LOOP_VECTORIZE", "SLP_VECTORIZE", "BOUNDSCHECK", "DEBUGINFO_DEFAULT")
"""Settings of Numba that change compiled code."""
CONFIG: Compiler = numba.config
MADE_BY = repr(
    (
        *(sys.version, numba.__version__, llvmlite.__version__, np.__version__, binding.get_process_triple()),
        *(CONFIG.CPU_NAME or binding.get_host_cpu_name(), CONFIG.CPU_FEATURES or binding.get_host_cpu_features()),
        *(PLAIN, CHECKED, *(getattr(CONFIG, name) for name in DECIDING)),
        *(hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(Path(__file__).parent.glob("*.py"))),
    )
)
"""What compiles, and for which CPU; read at the start, since sources may be edited meanwhile."""
SIMPLE = {bool, int, float, complex, str, bytes, type(None)}
MADE_OF: dict[Any, Callable[[Compiler], Iterable[Any]]] = {
    tuple: lambda one: (type(one).__qualname__, *one),
    CodeType: lambda one: (one.co_code, one.co_consts, one.co_names, one.co_varnames, one.co_argcount, one.co_flags),
    FunctionType: lambda one: options_of(one),
    type: lambda one: (one.__module__, one.__qualname__, *members_of(one)),
    list: list,
    dict: dict.items,
    (set, frozenset): lambda one: sorted(one, key=repr),
    Enum: lambda one: (type(one), one.name, one.value),
    (np.ndarray, np.generic): lambda one: (one.dtype, one.shape, one.strides, one.tolist()),
    Dispatcher: lambda one: (one.py_func, one.targetoptions),
    _Intrinsic: lambda one: (one._defn, one._prefer_literal),
    types.Dispatcher: lambda one: [one.dispatcher],
    Opened: lambda one: (one.name, one.fields),
    types.BaseNamedTuple: lambda one: (one.instance_class, *one),
}
"""Kinds of values that are made of others -> what a value is made of."""


class UnkeyedError(Exception):
    """A kernel reads a value of which nothing tells whether it is the same in another process; a line."""


@cache
def content_key(function: FunctionType) -> str:
    """Return the hash of what a kernel is compiled from, but for its options and the types of its arguments."""
    words, found = MADE_BY, [function]
    for one in found:  # which grows
        own, called = words_of_function(one)
        found += [other for other in dict.fromkeys(called) if other not in found]
        words += f"{own} {[found.index(other) for other in called]}\n"
    return hash_of(words)


def hash_of(words: str) -> str:
    """Return a hash that can be part of the name of a file."""
    return hashlib.sha256(words.encode()).hexdigest()[:24]


@cache
def words_of_function(function: FunctionType) -> tuple[str, tuple[FunctionType, ...]]:
    """Return a function and all that it reads as words, and the functions among that."""
    code, called = function.__code__, list[FunctionType]()
    cells = {name: cell.cell_contents for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True)}
    read = read_by(names_in(code), function.__globals__ | cells)
    try:
        return words_of([code, read, function.__defaults__, function.__kwdefaults__], called), tuple(called)
    except UnkeyedError as error:
        raise UnkeyedError(f"{code.co_filename}:{code.co_firstlineno}: {function.__name__} reads {error}") from None


def words_for(value: Any) -> str:  # noqa: ANN401  (types of Numba)
    """Return all that tells a value from others as words; UnkeyedError if there are none."""
    called = list[FunctionType]()
    return " ".join((words_of(value, called), *map(content_key, called)))


def names_in(code: CodeType) -> set[str]:
    """Return the names of variables and attributes that byte code reads, also that of functions within functions."""
    inner = [names_in(constant) for constant in code.co_consts if isinstance(constant, CodeType)]
    return {*code.co_names, *code.co_freevars}.union(*inner)


def read_by(names: set[str], known: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of the known among some names, and for a module those of its attributes with these names."""
    read = {name: known[name] for name in sorted(names) if name in known}
    for name, value in read.items():
        if isinstance(value, ModuleType) and not word_for(value):
            others = names - {name}  # modules may name each other
            read[name] = read_by(others, {one: getattr(value, one) for one in others if hasattr(value, one)})
    return read


def words_of(value: Any, called: list[FunctionType]) -> str:  # noqa: ANN401
    """Return what tells a value from others, and append the functions in it to `called`.

    Raises:
        UnkeyedError: nothing tells it.

    """
    if type(value) in SIMPLE:
        return repr(value)
    parts_of = next((parts for kind, parts in MADE_OF.items() if isinstance(value, kind)), None)
    named = parts_of is None or isinstance(value, FunctionType | type)
    if named and (word := word_for(value)):
        return word
    if parts_of is None:
        raise UnkeyedError(f"{value!r:.60}")
    if isinstance(value, FunctionType):
        called.append(value)
    return f"{type(value).__qualname__}({' '.join(words_of(part, called) for part in parts_of(value))})"


def word_for(value: Any) -> str:  # noqa: ANN401
    """Return the word for a part of a package whose version is known; "" for anything else."""
    place = value.__name__ if isinstance(value, ModuleType) else getattr(value, "__module__", None)
    place = place or type(value).__module__
    word = getattr(value, "__qualname__", "") or ("" if isinstance(value, ModuleType) else repr(value))
    ours = isinstance(value, type) and place.startswith("selforg.compiler.")  # `MADE_BY` has their sources
    of_process = word.endswith(">") and " at 0x" in word
    versioned = ours or place.partition(".")[0] in VERSIONED
    return f"{type(value).__qualname__} {place} {word}" if versioned and not of_process else ""


def members_of(cls: type) -> Iterable[Any]:
    """Return the fields of a named tuple, or the members of an enumeration; UnkeyedError for any other class."""
    if not issubclass(cls, tuple | BaseException | Enum):
        raise UnkeyedError(repr(cls))
    return getattr(cls, "_fields", ()), [(one.name, one.value) for one in cls] if issubclass(cls, Enum) else ()


def options_of(function: FunctionType) -> Iterable[Any]:
    """Return how a function is compiled into others: a part, or what `numba.extending.overload` has given it."""
    part = getattr(function, "_numba_type_", None)
    if part is not None:
        return [part.dispatcher.targetoptions]
    templates = [one for given, kind in builtin_registry.globals if given is function for one in kind.templates]
    return [(getattr(one, "_overload_func", one), getattr(one, "_jit_options", {})) for one in templates]
