"""The one place where compiled functions are declared.

Numba's decorator is untyped; this wrapper keeps the type of the function it compiles, so that `mypy --strict`
checks the callers. Compiled code is cached on disk. Numba's cache looks at the file of the compiled function only:
after a change to a function that is called from a kernel in *another* file, run `make clean-cache`.
"""

from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numba

P = ParamSpec("P")
R = TypeVar("R")


def kernel(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` in Numba's nopython mode, cached on disk, without fast-math (same seed, same bits)."""
    return cast("Callable[P, R]", numba.njit(cache=True, error_model="numpy")(function))


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a small function like `kernel`, into its callers: handing over arrays would cost more than its work."""
    return cast("Callable[P, R]", numba.njit(cache=True, error_model="numpy", forceinline=True)(function))
