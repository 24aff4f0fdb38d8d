"""The one place where compiled functions are declared.

Numba's decorators are untyped; these wrappers keep the type of the function they compile, so that `mypy --strict`
checks the callers. Kernels are cached on disk. Numba's cache looks at the file of the kernel only: after a change to a
function that is called from a kernel in *another* file, run `make clean-cache`.

What a process compiles first costs time for each function: `part` and `lean_kernel` leave out what is not needed, and
the garbage collector waits, which would else look through all that the compiler makes again and again.
"""

import gc
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

import numba
from numba.core import event
from numba.extending import register_jitable

P = ParamSpec("P")
R = TypeVar("R")

COMPILED = not numba.config.DISABLE_JIT  # type: ignore[attr-defined]
"""Whether anything is compiled at all."""
LEAN = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}
"""Options of functions that make no arrays: references to arrays are not counted, the caller holds them anyway."""


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


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` in Numba's nopython mode, cached on disk, without fast-math (same seed, same bits)."""
    return cast("Callable[P, R]", numba.njit(cache=True, error_model="numpy")(function))


def lean_kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile like `kernel` a function that makes no arrays: a call costs a third less, compiling it a fifth.

    It may look into the arrays that it is given, but must copy slices number by number.
    """
    options: Any = {**LEAN, "cache": True}
    return cast("Callable[P, R]", numba.njit(**options)(function))


def part(function: Callable[P, R]) -> Callable[P, R]:
    """Compile, whenever a kernel that calls it is compiled, a function that makes no arrays; see `lean_kernel`.

    Called from Python it stays what it is, slow, as tests may want it.
    """
    return register_jitable(**LEAN)(function)


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a small function like `part`, into its callers: handing over arrays would cost more than its work."""
    return register_jitable(**LEAN, forceinline=True)(function)
