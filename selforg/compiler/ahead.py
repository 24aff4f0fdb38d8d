"""Compiling before the first call: a line of text names a kernel and the types of its arguments.

For example `selforg.space.shorten float64[2C] float64[1C]`.
"""

import re
from typing import Any

from numba import types

from selforg.compiler.decorators import KERNELS
from selforg.compiler.intrinsics import Compiler

NUMBER_TYPES: dict[str, Compiler] = {
    str(kind): kind for kind in (types.boolean, types.uint8, types.int32, types.int64, types.float32, types.float64)
}
ARRAY = re.compile(r"(\w+)\[(\d)([CA])\]")
"""Kind of the numbers, number of axes, and layout: C-contiguous, or any."""


def compile_line(line: str) -> None:
    """Compile a kernel for the types of a line, or load it from the disk; errors are those of the compiler.

    Raises:
        KeyError: there is no such kernel or type.

    """
    name, *texts = line.split()
    KERNELS[name].compile(tuple(map(_type_of, texts)))


def _type_of(text: str) -> Compiler:
    array = ARRAY.fullmatch(text)
    if array is None:
        return NUMBER_TYPES[text]
    layout: Any = array[3]
    return types.Array(NUMBER_TYPES[array[1]], int(array[2]), layout)
