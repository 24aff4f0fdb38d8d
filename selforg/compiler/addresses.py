"""Numbers at addresses, for compiled code that reads arrays of many shapes in one loop."""

from collections.abc import Callable
from typing import cast

from numba import types
from numba.extending import intrinsic

from selforg.compiler.llvm import Compiler


def _number_at(kind: Compiler) -> Callable[[int], float]:
    """Return the function that gives compiled code the number at an address."""

    def typed(typing: Compiler, address: Compiler) -> Compiler:
        def generate(context: Compiler, builder: Compiler, signature: Compiler, arguments: Compiler) -> Compiler:
            return builder.load(builder.inttoptr(arguments[0], context.get_data_type(kind).as_pointer()))

        return kind(types.int64), generate

    return cast("Callable[[int], float]", intrinsic(typed))


float_at, int_at, byte_at = _number_at(types.float64), _number_at(types.int64), _number_at(types.uint8)
