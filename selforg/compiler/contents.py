"""What a kernel is compiled from, as a hash, under which its compiled code is kept.

It covers the byte code of the kernel and of all functions that are compiled into it, wherever these lie, the values of
the globals and closures that they read, the compiler and the CPU. It does not depend on where files lie, on the names
by which they were imported, or on lines and comments (docs/decisions/0050-kernel-cache.md).
"""

import hashlib
import sys
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

from selforg.compiler.intrinsics import Compiler
from selforg.compiler.switches import CHECKED, PLAIN

VERSIONED = sys.stdlib_module_names | {"numba", "numpy", "llvmlite"}
"""Packages of which a name is enough, since their versions are in every key."""
SETTINGS = ("OPT", "ENABLE_AVX", "LOOP_VECTORIZE", "SLP_VECTORIZE", "BOUNDSCHECK", "DEBUGINFO_DEFAULT")
"""Settings of Numba that change compiled code."""
OF_CODE = ("co_code", "co_names", "co_varnames", "co_cellvars", "co_freevars", "co_argcount", "co_flags")
"""What decides, with the constants, what byte code does."""

PLAIN_KINDS = {bool, int, float, complex, str, bytes, type(None)}
COMPOSITE: tuple[Compiler, ...] = (
    *(tuple, list, dict, set, frozenset, Enum, CodeType, np.ndarray, np.generic),
    *(Dispatcher, _Intrinsic, types.Dispatcher, types.BaseNamedTuple),
)
"""Kinds of values that are made of others."""


class UnkeyedError(Exception):
    """A kernel reads a value that nothing compares with that of another process; the message is a line."""


@cache
def key_of(function: FunctionType) -> str:
    """Return the hash of what a kernel is compiled from, but for its options and the types of its arguments."""
    digest, found = hashlib.sha256(compiler().encode()), [function]
    for one in found:  # which grows
        words, called = words_of_function(one)
        found += [other for other in dict.fromkeys(called) if other not in found]
        digest.update(f"{words} {[found.index(other) for other in called]}\n".encode())
    return digest.hexdigest()[:32]


@cache
def compiler() -> str:
    """Return what compiles, and for which CPU."""
    config: Compiler = numba.config
    sources = [path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py"))]
    return " ".join(
        map(
            str,
            (
                *(sys.version, numba.__version__, llvmlite.__version__, np.__version__),
                *(binding.get_process_triple(), config.CPU_NAME or binding.get_host_cpu_name()),
                *(config.CPU_FEATURES or binding.get_host_cpu_features().flatten(), PLAIN, CHECKED),
                *(getattr(config, name) for name in SETTINGS),
                hashlib.sha256(b"".join(sources)).hexdigest(),
            ),
        )
    )


@cache
def words_of_function(function: FunctionType) -> tuple[str, tuple[FunctionType, ...]]:
    """Return a function and all that it reads as words, and the functions among that."""
    code, known = function.__code__, function.__globals__
    words, called = list[str](), list[FunctionType]()
    names = names_in(code)
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    read = {name: known[name] for name in sorted(names) if name in known}
    try:
        note((code, cells, read, function.__defaults__, function.__kwdefaults__), names, words, called)
    except UnkeyedError as error:
        raise UnkeyedError(f"{code.co_filename}:{code.co_firstlineno}: {function.__name__} reads {error}") from None
    return " ".join(words), tuple(called)


def words_for(value: Any) -> str:  # noqa: ANN401  (types of Numba)
    """Return what tells a value from others that is made of no module; UnkeyedError if nothing does."""
    words, called = list[str](), list[FunctionType]()
    note(value, set(), words, called)
    return " ".join((*words, *map(key_of, called)))


def names_in(code: CodeType) -> set[str]:
    """Return the names of globals and of attributes in byte code, also of functions within functions."""
    return set(code.co_names).union(*(names_in(inner) for inner in code.co_consts if isinstance(inner, CodeType)))


def note(value: Any, names: set[str], words: list[str], called: list[FunctionType]) -> None:  # noqa: ANN401
    """Append what tells a value from others to `words`, and a function to `called`. Modules count by `names` only.

    Raises:
        UnkeyedError: nothing tells it.

    """
    if type(value) in PLAIN_KINDS:
        words.append(repr(value))
    elif not isinstance(value, COMPOSITE) and (word := word_for(value)):
        words.append(word)
    else:
        if isinstance(value, FunctionType):
            called.append(value)
        words.append(f"{type(value).__qualname__}(")
        for part in parts_of(value, names):
            inner = names - {part[0]} if isinstance(value, ModuleType) else names  # modules may name each other
            note(part, inner, words, called)
        words.append(")")


def word_for(value: Any) -> str:  # noqa: ANN401
    """Return the word for a part of a package whose version is known; "" for anything else."""
    module = value if isinstance(value, ModuleType) else None
    place = module.__name__ if module else getattr(value, "__module__", None) or type(value).__module__
    word = getattr(value, "__qualname__", "") or repr(value)
    ours = isinstance(value, type) and place.startswith("selforg.compiler.")  # `compiler` has their sources
    told = not (word.endswith(">") and " at 0x" in word)
    return (
        f"{type(value).__qualname__} {place} {word}" if told and (ours or place.partition(".")[0] in VERSIONED) else ""
    )


def parts_of(value: Any, names: set[str]) -> tuple[Any, ...]:  # noqa: ANN401
    """Return what a value is made of, for `words_of`."""
    match value:
        case Enum():
            return type(value), value.name, value.value
        case tuple():
            return (type(value).__qualname__, *value)
        case list():
            return tuple(value)
        case dict():
            return tuple(value.items())
        case set() | frozenset():
            return tuple(sorted(value, key=repr))
        case np.ndarray() | np.generic() if not value.dtype.hasobject:
            return value.dtype, value.shape, value.strides, value.tobytes()
        case CodeType():
            return repr([getattr(value, one) for one in OF_CODE]), value.co_consts
        case FunctionType():
            part = getattr(value, "_numba_type_", None)
            return (part.dispatcher.targetoptions,) if part else overloads_of(value)
        case ModuleType():
            return tuple((name, getattr(value, name)) for name in sorted(names) if hasattr(value, name))
        case Dispatcher():
            return value.py_func, value.targetoptions
        case _Intrinsic():
            return value._defn, value._prefer_literal
        case types.Dispatcher():
            return (value.dispatcher,)
        case types.BaseNamedTuple():
            return value.instance_class, *value  # type: ignore[attr-defined, misc]
        case type() if issubclass(value, tuple | BaseException):
            return value.__module__, value.__qualname__, getattr(value, "_fields", ())
        case type() if issubclass(value, Enum):
            return value.__module__, value.__qualname__, *((one.name, one.value) for one in value)
        case _:
            raise UnkeyedError(f"{value!r:.60}, which compiled code cannot be kept with")


def overloads_of(function: FunctionType) -> tuple[Any, ...]:
    """Return what `numba.extending.overload` has registered for a function, with the options."""
    kinds = [kind for given, kind in builtin_registry.globals if given is function]
    templates = [template for kind in kinds for template in kind.templates]
    return tuple((getattr(one, "_overload_func", one), getattr(one, "_jit_options", {})) for one in templates)
