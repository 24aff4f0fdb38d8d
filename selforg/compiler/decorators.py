"""The decorators by which functions are compiled.

Numba's decorators have no types; these keep the type of the function that they compile, so that `mypy --strict` checks
the callers. Kernels are kept on disk, see `selforg.compiler.cache`.

Compiling takes time when a process starts with an empty cache. `part` and `lean_kernel` therefore leave out unneeded
parts, and the garbage collector is off while anything is compiled: it would visit all objects of the compiler again
and again.
"""

import gc
from collections.abc import Callable
from types import FunctionType
from typing import Any, Generic, ParamSpec, TypeVar, cast

import numba
from numba.core import event
from numba.core.registry import CPUDispatcher
from numba.extending import register_jitable

from selforg.compiler.cache import KernelCache
from selforg.compiler.parts import known_to_kernels
from selforg.compiler.switches import BY_ADDRESS, COMPILED, LEAN, NUMPY_ERRORS, PLAIN

P = ParamSpec("P")
R = TypeVar("R")

UNLOCKED = {"nogil": True}
"""Option of kernels that run without Python's lock."""
KERNELS: dict[str, Any] = {}
"""Kernels that are kept on disk, by module and name; see `selforg.compiler.ahead`."""


class WithoutCollector(event.Listener):
    """Stops the garbage collector while anything is compiled; compiling one function may compile others."""

    def __init__(self) -> None:
        self._depth, self._was_on = 0, False

    def on_start(self, event: event.Event) -> None:
        """Note that a function begins to be compiled."""
        if self._depth == 0:
            self._was_on = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: event.Event) -> None:
        """Note that a function is compiled, or cannot be."""
        self._depth -= 1
        if self._depth == 0 and self._was_on:
            gc.enable()


event.register("numba:compile", WithoutCollector())  # type: ignore[no-untyped-call]


class Kernel(CPUDispatcher):
    """A kernel, which is a part of other kernels where these call it: it is then not compiled by itself as well."""

    within: Any = None
    """The function that other kernels know it by; a pickled kernel has none, and is a function of its own to them."""

    @property
    def _numba_type_(self) -> Any:  # noqa: ANN401
        return cast("Any", self.within or super())._numba_type_


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` in Numba's nopython mode, kept on disk, without fast-math (same seed, same bits).

    Other threads run meanwhile, as in a `long_kernel`.
    """
    return compiled(function, {**NUMPY_ERRORS, **UNLOCKED})


def lean_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile like `kernel` a function that makes no arrays: a call costs a third less, compiling it a fifth.

    The function may look into the arrays that it is given, but must copy slices number by number.
    """
    return compiled(function, LEAN)


def long_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile like `lean_kernel` a function that takes long for many rows: other threads run meanwhile.

    To give Python's lock up and take it again costs 0.1 us, and a wait where threads compete: short kernels keep it.
    """
    return compiled(function, {**LEAN, **UNLOCKED})


def part(function: Callable[P, R]) -> Callable[P, R]:
    """Compile, whenever a kernel that calls it is compiled, a function that makes no arrays; see `lean_kernel`.

    Called from Python, the function runs uncompiled, as some tests want it.
    """
    return within_kernels(function, LEAN)


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a small function like `part`, into its callers, because passing arrays would cost more than its work."""
    return within_kernels(function, {**LEAN, "forceinline": True})


def within_kernels(function: Callable[P, R], options: dict[str, Any]) -> Callable[P, R]:
    """Compile `function` into its compiled callers."""
    if PLAIN or not COMPILED:
        return register_jitable(**options)(function)
    return known_to_kernels(function, options)


class Template(Generic[P, R]):
    """A kernel in which one function is still open.

    Args:
        function: the kernel, not compiled.
        called: the function of its module in whose place others are put.

    """

    def __init__(self, function: Callable[P, R], called: Callable[..., Any]) -> None:
        self._function, self._called = cast("FunctionType", function), called.__name__
        self._kernels: dict[Callable[..., Any], Callable[P, R]] = {}

    def of(self, part: Callable[..., Any], origin: Callable[..., Any] | None = None) -> Callable[P, R]:
        """Return the kernel that calls `part`, compiled like `long_kernel`.

        It is named after `origin`, from which `part` is made (None: `part` itself).
        """
        if part not in self._kernels:
            named = f"{self._function.__name__}_{(origin or part).__qualname__}"
            copy = FunctionType(self._function.__code__, {**self._function.__globals__, self._called: part})
            copy.__qualname__ = named
            self._kernels[part] = cast("Callable[P, R]", compiled(copy, {**LEAN, **UNLOCKED}))
        return self._kernels[part]


def template(called: Callable[..., Any]) -> Callable[[Callable[P, R]], Template[P, R]]:
    """Make a function a `Template`, as a decorator: `called` stands in it for what is still open."""
    return lambda function: Template(function, called)


def compiled(function: Callable[P, R], options: dict[str, Any]) -> Callable[P, R]:
    """Compile `function`, or load the code that was compiled from the same contents."""
    dispatcher = numba.njit(**options)(function)
    if BY_ADDRESS:
        dispatcher.__class__ = Kernel
        dispatcher.within = known_to_kernels(cast("FunctionType", function), options)
    dispatcher._cache = KernelCache(cast("FunctionType", function), options)
    KERNELS.setdefault(f"{function.__module__}.{function.__qualname__}", dispatcher)
    return cast("Callable[P, R]", dispatcher)
