"""Bundles: arrays and numbers that compiled code takes as one argument.

Handing an array over costs Numba a good deal of a microsecond's tenth, twice that inside a tuple, and a tick hands over
some two hundred. A bundle is an array of words in which everything stands as compiled code wants it; it is made once,
and unbundling it costs nothing. Whoever owns the arrays makes the bundle, and makes it anew when an array is replaced.
"""

from collections.abc import Callable
from typing import Any, TypeAlias, cast

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from selforg.arrays import Ints
from selforg.compiler.switches import COMPILED

Compiler: TypeAlias = Any  # Numba and LLVM are not typed
LLVM: Compiler = cgutils
Kind: TypeAlias = Any  # of Numba: what one entry of a bundle is
Bundle: TypeAlias = Any
"""(words,) int64; where nothing is compiled, the entries themselves."""

NUMBER, WHOLE = types.float64, types.int64
DTYPES = {"f": types.float64, "i": types.int64, "l": types.int32, "u": types.uint8, "b": types.bool_}


def array_kind(name: str) -> Kind:
    """Return the kind of a C-contiguous array: "f2" is float64 of two axes; i int64, l int32, u uint8, b bool."""
    return types.Array(DTYPES[name[0]], int(name[1:]), "C")


def words_of(kind: Kind, value: Any, where: str) -> list[int]:  # noqa: ANN401  (arrays and numbers)
    """Return one entry as compiled code lays it out."""
    if kind is NUMBER:
        return [int(np.float64(value).view(np.int64))]
    if kind is WHOLE:
        return [int(value)]
    fits = isinstance(value, np.ndarray) and value.flags.c_contiguous and value.flags.writeable
    if not fits or value.ndim != kind.ndim or value.dtype.name != kind.dtype.name.replace("bool_", "bool"):
        got = f"{value.dtype} {value.shape}" if isinstance(value, np.ndarray) else repr(value)
        raise TypeError(f"{where}: expected a C-contiguous {kind.dtype} array of {kind.ndim} axes, got {got}")
    # memory owner and parent (none: the bundle keeps the array), items, their size, data, shape, strides
    return [0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides]


class Layout:
    """What a bundle holds: each entry "number", "whole", or the name of an array as `array_kind` takes it.

    Example:
        >>> LAYOUT = Layout("i1", "number")
        >>> unbundle: Callable[[Bundle], tuple[Ints, float]] = LAYOUT.unbundle
        >>> @lean_kernel
        ... def total(bundle): numbers, factor = unbundle(bundle); return numbers[0] * factor

    """

    def __init__(self, *entries: str) -> None:
        numbers = {"number": NUMBER, "whole": WHOLE}
        self._kinds = [numbers.get(entry) or array_kind(entry) for entry in entries]
        self.unbundle: Callable[[Bundle], Any] = same
        if COMPILED:
            kind: Kind = types.Tuple(self._kinds)  # type: ignore[no-untyped-call]
            self.unbundle = unbundling(kind)

    def bundle(self, *entries: Any) -> Bundle:  # noqa: ANN401  (arrays and numbers)
        """Return a bundle of the entries; it keeps arrays alive, which must stay where they are."""
        if not COMPILED:
            return entries
        if len(entries) != len(self._kinds):
            raise TypeError(f"bundle: expected {len(self._kinds)} entries, got {len(entries)}")
        words = []
        for number, (kind, entry) in enumerate(zip(self._kinds, entries, strict=True)):
            words += words_of(kind, entry, f"bundle, entry {number}")
        return np.asarray(Kept(np.array(words, dtype=np.int64), entries))


class Kept:
    """Words that keep the arrays alive to which they point: NumPy keeps the owner of the memory that it shows."""

    def __init__(self, words: Ints, entries: tuple[Any, ...]) -> None:
        self.words, self.entries = words, entries
        self.__array_interface__ = words.__array_interface__


def same(bundle: Bundle) -> Any:  # noqa: ANN401  (a tuple of anything)
    """Return the entries of a bundle where nothing is compiled."""
    return bundle


def unbundling(kind: Kind) -> Callable[[Bundle], Any]:
    """Return the function that gives compiled code the entries, a tuple of Numba's type `kind`."""

    def typed(typing: Compiler, bundle: Compiler) -> Compiler:
        def generate(context: Compiler, builder: Compiler, signature: Compiler, arguments: Compiler) -> Compiler:
            words = context.make_array(signature.args[0])(context, builder, arguments[0])
            pointer = builder.bitcast(words.data, context.get_value_type(kind).as_pointer())
            return builder.load(pointer, align=8)

        return kind(bundle), generate

    made: Compiler = intrinsic(typed)
    return cast("Callable[[Bundle], Any]", made)
