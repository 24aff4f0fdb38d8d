"""Names for what Numba and LLVM hand to code that generates code; neither has types."""

from typing import Any, TypeAlias

from numba.core import cgutils

Compiler: TypeAlias = Any
LLVM: Compiler = cgutils
