"""Records: named arrays and numbers that compiled code takes as one argument.

Passing one array to a kernel costs about 0.06 us, and a tick passes some two hundred. A record is passed as one array
of words, its handle: addresses, shapes and numbers, laid out as compiled code wants them. Opening it there costs
nothing (docs/decisions/0046-records.md).

A record is a NamedTuple whose fields say what they hold, and what compiled code that opens it does with them: READ
only, write what is KEPT or CLOCKED, or overwrite SCRATCH (`selforg.arrays`):

    class Grid(NamedTuple):
        cells: Annotated[Floats, "L 6", READ]  # number and width [m] of cells along x, y, z, for each level
        links: Annotated[Links, "M", KEPT]  # next gradient in the same cell
        extent: float  # [m]

    open_grid = opening(Grid)

    @lean_kernel
    def look(grid: Handle[Grid]) -> float:
        g = open_grid(grid)
        return g.cells[0, 1] * g.extent

    packed = Packed(Grid(cells, links, 11.0))
    look(packed.handle)

The owner of the arrays packs the record, and replaces it when an array is replaced by another. The handle stays where
it is, so that whoever holds its address reads the new record.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from typing import Annotated, Any, Generic, TypeVar, cast, get_args, get_origin, get_type_hints

import numpy as np
from numba import types
from numba.extending import intrinsic, register_jitable

from selforg.arrays import Ints, Mark, scalar_of
from selforg.compiler.intrinsics import LLVM, Compiler, Opened
from selforg.compiler.switches import BY_ADDRESS, CHECKED

Record = TypeVar("Record", bound=tuple[Any, ...])

NUMBERS: dict[type, Compiler] = {float: types.float64, int: types.int64}


class Handle(Generic[Record]):
    """What compiled code takes for a record: words (K,) int64, or the record itself if none is passed by address."""


Written = Handle
"""The same, in the signatures of kernels that write what the record keeps; tests hold that to be true."""


class Packed(Generic[Record]):
    """A record with its handle.

    A copy or a pickle is packed again, on the copied arrays. An array that owner and record share is shared by their
    copies too, if both are copied in one go.

    Attributes:
        record: the arrays and numbers; the arrays must stay where they are.
        handle: what kernels take.

    Raises:
        TypeError: names a field that compiled code would misread.

    """

    def __init__(self, record: Record) -> None:
        recording: Recording[Record] = Recording.of[type(record)]
        self.record = record
        self.handle = recording.handle_of(record)

    def replace(self, record: Record) -> None:
        """Hold another record of the same class from now on; compiled code reads it at the same address."""
        recording: Recording[Record] = Recording.of[type(self.record)]
        for name in recording.of_rows:
            had, given = len(getattr(self.record, name)), len(getattr(record, name))
            if given < had:  # programs were made with its rows
                raise ValueError(f"{type(record).__name__}.{name}: expected at least {had} rows, got {given}")
        fresh: Any = recording.handle_of(record)
        self.record = record
        if not BY_ADDRESS:
            self.handle = fresh
            return
        words: Any = self.handle
        words[:], words.base.record = fresh, record

    def __reduce__(self) -> tuple[Any, ...]:
        return Packed, (self.record,)


def opening(kind: type[Record]) -> Callable[[Handle[Record]], Record]:
    """Declare a class of records, and return the function that opens their handles in compiled code."""
    return Recording(kind).open


class Recording(Generic[Record]):
    """How records of one class are packed, and opened in compiled code.

    Attributes:
        kind: the class, a NamedTuple; fields are float, int, or `Annotated[ARRAY, SHAPE, MARK]` with an array type and
            a mark of `selforg.arrays`, and a name for each axis, by spaces.
        open: returns, in compiled code, the record whose handle it is given.
        of_rows: names of the arrays whose first axis is R, one entry for each row.

    """

    of: dict[type, Any] = {}  # noqa: RUF012  (all recordings, by their class: a copy looks its own up)

    def __init__(self, kind: type[Record]) -> None:
        self.kind = kind
        hints = get_type_hints(kind, include_extras=True)
        for name, hint in hints.items():
            if hint not in NUMBERS and not any(isinstance(given, Mark) for given in get_args(hint)):
                raise TypeError(f"{kind.__name__}.{name}: expected Annotated[ARRAY, 'AXES', MARK], got {hint}")
        self._fields = {name: numba_type(hint, f"{kind.__name__}.{name}") for name, hint in hints.items()}
        self._shapes = {name: get_args(hint)[1] for name, hint in hints.items() if get_origin(hint) is Annotated}
        self.of_rows = [name for name, shape in self._shapes.items() if shape.split()[0] == "R"]
        self._tag = int.from_bytes(
            hashlib.sha256(f"{kind.__module__}.{kind.__qualname__}".encode()).digest()[:7], "big"
        )
        self.open: Callable[[Handle[Record]], Record] = self._opening() if BY_ADDRESS else same_record
        Recording.of[kind] = self

    def handle_of(self, record: Record) -> Handle[Record]:
        """Return the handle of a record, which keeps its arrays alive."""
        if type(record) is not self.kind:
            raise TypeError(f"expected a {self.kind.__name__}, got {type(record).__name__}")
        words = [self._tag]
        for (name, field), value in zip(self._fields.items(), record, strict=True):
            words += words_of_field(field, value, f"{self.kind.__name__}.{name}", self._shapes.get(name, ""))
        if not BY_ADDRESS:
            return cast("Handle[Record]", record)
        return cast("Handle[Record]", np.asarray(Kept(np.array(words, dtype=np.int64), record)))

    def _opening(self) -> Callable[[Handle[Record]], Record]:
        """Return the function that gives compiled code the fields by their names."""
        opened = Opened(f"{self.kind.__module__}.{self.kind.__qualname__}", self._fields)
        tag, message = self._tag, f"this is not the handle of a record {self.kind.__name__}"

        def typed(typing: Compiler, words: Compiler) -> Compiler:
            def generate(context: Compiler, builder: Compiler, signature: Compiler, arguments: Compiler) -> Compiler:
                array = context.make_array(signature.args[0])(context, builder, arguments[0])
                if CHECKED:
                    wrong = builder.icmp_unsigned("!=", builder.load(array.data), LLVM.ir.IntType(64)(tag))
                    with builder.if_then(wrong, likely=False):
                        context.call_conv.return_user_exc(builder, TypeError, (message,))
                return builder.bitcast(array.data, context.get_value_type(opened))

            return opened(words), generate

        return cast("Callable[[Handle[Record]], Record]", intrinsic(typed))


@register_jitable
def same_record(record: Any) -> Any:  # noqa: ANN401  (any record)
    """Return the record itself, if none is passed by address."""
    return record


def numba_type(hint: Any, where: str) -> Compiler:  # noqa: ANN401  (a type hint)
    """Return Numba's type for the type hint of a field."""
    if hint in NUMBERS:
        return NUMBERS[hint]
    _, axes, *_ = get_args(hint)
    scalar = scalar_of(hint)
    if not isinstance(axes, str):
        raise TypeError(f"{where}: expected Annotated[ARRAY, 'AXIS AXIS ...', MARK], got {hint!r}")
    kind = types.bool_ if scalar is np.bool_ else getattr(types, np.dtype(scalar).name)
    return types.Array(kind, len(axes.split()), "C")


def words_of_field(field: Compiler, value: Any, where: str, shape: str) -> list[int]:  # noqa: ANN401
    """Return one field as compiled code lays it out."""
    if field is types.float64:
        return [int(np.float64(value).view(np.int64))]
    if field is types.int64:
        return [int(value)]
    fits = isinstance(value, np.ndarray) and value.flags.c_contiguous and value.flags.writeable
    fits = fits and value.ndim == field.ndim and value.dtype.name == field.dtype.name.replace("bool_", "bool")
    if not fits or any(value.shape[axis] != length for axis, length in lengths_in(shape)):
        got = f"{value.dtype} {value.shape}" if isinstance(value, np.ndarray) else repr(value)
        raise TypeError(f"{where}: expected a C-contiguous {field.dtype} array ({shape.replace(' ', ', ')}), got {got}")
    return [value.ctypes.data, *value.shape]


@cache
def lengths_in(shape: str) -> list[tuple[int, int]]:
    """Return the axes that a shape gives a length, with it."""
    return [(axis, int(name)) for axis, name in enumerate(shape.split()) if name.isdecimal()]


class Kept:
    """Words, and the record whose arrays they point to: an array of these words keeps this object, its owner, alive."""

    def __init__(self, words: Ints, record: tuple[Any, ...]) -> None:
        self.words, self.record = words, record
        self.__array_interface__ = words.__array_interface__
