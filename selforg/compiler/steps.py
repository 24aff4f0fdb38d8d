"""Compiled steps called by address, one after the other, from one compiled loop.

A step is a kernel `(now, rows, *handles) -> int`. A table has a row of words for each step, so that a call costs a
tenth of one from Python (docs/decisions/0226-a-tick-is-a-program.md).
"""

import re
from collections.abc import Callable, Sequence
from inspect import get_annotations
from typing import Any, Final, cast

from numba import types
from numba.extending import intrinsic
from numba.np import arrayobj

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import long_kernel
from selforg.compiler.intrinsics import LLVM, Compiler, int_at
from selforg.compiler.records import Packed, Recording

MOST_RECORDS: Final = 6
"""Records that a step may take."""
_ADDRESS, _COUNT, _LISTED, _RECORDS, _ALWAYS, _STAGE, _FIRST_RECORD = range(7)
"""Columns of the table: the address of the step, 0 for one in Python; of the number of its rows, and of their list; how
many records it takes; 1 if it is called without rows, too; 2 to the power of its stage; and the addresses of the words
of its records."""
STEP_COLUMNS: Final = _FIRST_RECORD + MOST_RECORDS
WORDS: Compiler = types.Array(types.int64, 1, "C")
FILL: Compiler = arrayobj.populate_array
RECORD = re.compile(r"(?:Handle|Written)\[(?:.*\.)?(\w+)\]$")
"""How a kernel says which record a parameter is."""


def words_of_step(
    kernel: Any,  # noqa: ANN401
    rows: tuple[Ints, Ints],
    records: Sequence[Packed[Any]],
    always: bool,
    stage: int,
) -> list[int]:
    """Return the row of the table for a kernel, or for Python with None, with a list of rows and their number.

    Raises:
        TypeError: the kernel takes other records, or them in another order; or it returns no int.
        ValueError: an array of a record, of an entry for each row, is shorter than the list or ends before its rows.

    """
    told = map(str, get_annotations(kernel.py_func).values() if kernel else ())  # the dispatcher has none from 3.14 on
    wanted = [one[1] for one in map(RECORD.search, told) if one]
    got = [type(one.record).__name__ for one in records]
    if wanted and wanted != got:
        raise TypeError(f"step {kernel.__name__}: expected the records {wanted}, got {got}")
    length = max(len(rows[0]), int(rows[0][: rows[1][0]].max(initial=-1)) + 1)
    for record in (one.record for one in records):
        for name in Recording.of[type(record)].of_rows:
            found = len(getattr(record, name))
            if found < length:
                where = f"{type(record).__name__}.{name}"
                raise ValueError(f"step {kernel.__name__}: expected at least {length} rows in {where}, got {found}")
    head = 0 if kernel is None else address_of(kernel, len(records)), rows[1].ctypes.data, rows[0].ctypes.data
    addresses = [cast("Any", packed.handle).ctypes.data for packed in records] + [0] * (MOST_RECORDS - len(records))
    return [*head, len(records), int(always), 1 << stage, *addresses]


def address_of(kernel: Any, records: int) -> int:  # noqa: ANN401
    """Return the address of the compiled code of a step that takes a number of records."""
    kinds = _kinds_of(records)
    kernel.compile(kinds)
    compiled, unliteral = kernel.overloads[kinds], cast("Compiler", types.unliteral)
    if unliteral(compiled.signature.return_type) != types.int64:
        raise TypeError(f"step {kernel.__name__}: expected a result of int64, got {compiled.signature.return_type}")
    return int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name))


def _kinds_of(records: int) -> tuple[Compiler, ...]:
    """Return the types of the arguments of a step that takes a number of records."""
    return types.float64, WORDS, *(WORDS,) * records


@intrinsic
def call_step(typing: Compiler, table: Compiler, at: Compiler, now: Compiler) -> Compiler:
    """Call the step in row `at` of the table, and return its result."""

    def generate(context: Compiler, builder: Compiler, signature: Compiler, arguments: Compiler) -> Compiler:
        whole = context.make_array(signature.args[0])(context, builder, arguments[0])
        width, one = context.get_constant(types.int64, STEP_COLUMNS), context.get_constant(types.intp, 1)
        step = builder.gep(whole.data, [builder.mul(arguments[1], width)])

        def word(column: int) -> Compiler:
            return builder.load(LLVM.gep(builder, step, column))

        def words_at(address: Compiler, count: Compiler) -> Compiler:
            array, size = context.make_array(WORDS)(context, builder), context.get_constant(types.intp, 8)
            data = builder.inttoptr(address, array.data.type)
            FILL(array, data, shape=[count], strides=[size], itemsize=size, meminfo=None)
            return array._getvalue()

        rows = words_at(word(_LISTED), builder.load(builder.inttoptr(word(_COUNT), whole.data.type)))
        result, end = LLVM.alloca_once(builder, LLVM.ir.IntType(64)), builder.append_basic_block("end")
        none = builder.append_basic_block("none")
        chosen = builder.switch(word(_RECORDS), none)
        for records in range(MOST_RECORDS + 1):
            kinds = _kinds_of(records)
            block = builder.append_basic_block(f"records.{records}")
            chosen.add_case(context.get_constant(types.int64, records), block)
            builder.position_at_end(block)
            given = [arguments[2], rows, *(words_at(word(_FIRST_RECORD + k), one) for k in range(records))]
            shape = context.call_conv.get_function_type(types.int64, kinds)
            function = builder.inttoptr(word(_ADDRESS), shape.as_pointer())
            status, answer = context.call_conv.call_function(builder, function, types.int64, kinds, given)
            with builder.if_then(status.is_error, likely=False):
                context.call_conv.return_status_propagate(builder, status)
            builder.store(answer, result)
            builder.branch(end)
        builder.position_at_end(none)
        builder.unreachable()
        builder.position_at_end(end)
        return builder.load(result)

    return types.int64(table, types.int64, types.float64), generate


_call: Callable[[Ints, int, float], int] = cast("Any", call_step)


@long_kernel
def run_steps(now: float, begin: int, without: int, table: Ints) -> tuple[int, int]:
    """Run the steps of `table` (S, STEP_COLUMNS) from `begin` on at `now` [s], until one needs Python.

    Steps of the stages whose bits are in `without` are left out. Returns which step needs Python, S if none, and its
    result, 0 for one that is in Python.
    """
    for at in range(begin, table.shape[0]):
        step = table[at]
        if step[_STAGE] & without or (int_at(step[_COUNT]) == 0 and step[_ALWAYS] == 0):
            continue
        if step[_ADDRESS] == 0:
            return at, 0
        result = _call(table, at, now)
        if result != 0:
            return at, result
    return table.shape[0], 0


@long_kernel
def repeat_steps(
    ticks: Ints, length: float, now: Floats, begin: int, times: int, without: int, table: Ints
) -> tuple[int, int, int]:
    """Run all steps several times as `run_steps` does, the first time from `begin` on, until one needs Python.

    Each time begins at `ticks` (1,) times `length` [s], which is written into `now` (1,); some step counts `ticks` on.
    Returns what `run_steps` does, and how many times are left, the present one included.
    """
    at, result = table.shape[0], 0
    while times > 0:
        if begin == 0:
            now[0] = ticks[0] * length
        at, result = run_steps(now[0], begin, without, table)
        if at < table.shape[0]:
            break
        begin, times = 0, times - 1
    return at, result, times
