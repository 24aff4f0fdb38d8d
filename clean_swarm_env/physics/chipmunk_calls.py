"""Calls of Chipmunk's C functions from compiled code, by their addresses: what a substep in contact needs.

A call from Python costs about as much as the work of a small space. The addresses come from `contact_space.py` as a
table of handles, one row for each world. Compiled code leaves a world without handles to Python.
"""

from numba import types
from numba.extending import intrinsic, overload

from selforg.arrays import Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.llvm import LLVM, Compiler

IR: Compiler = LLVM.ir

# handles (W, HANDLES) int64, addresses, all zero where a world has no space that compiled code may step
(
    SPACE,
    STEP,  # void (space, double timestep)
    EACH,  # void (space, void (body, data), data)
    WRITE_BODY,  # void (body, data), fields of the next body from an array
    READ_BODY,  # void (body, data), fields of the next body into an array
    BODIES,  # data: positions and velocities of all bodies
    BODIES_DONE,  # int32 in that data: how many numbers have been read or written
    FORCES,  # data: forces on all bodies
    FORCES_DONE,
    HANDLES,
) = range(10)


def step_space(function: int, space: int, timestep: float) -> None:
    """Call `function` (space, timestep [s]); in compiled code only."""
    raise NotImplementedError("C functions are called from compiled code only")


def each_body(function: int, space: int, visitor: int, data: int, done: int) -> None:
    """Set the int32 at `done` to 0 and call `function` (space, visitor, data); in compiled code only."""
    raise NotImplementedError("C functions are called from compiled code only")


def pointer_to(builder: Compiler, address: Compiler, kind: Compiler) -> Compiler:
    """Return an address as a pointer to `kind`."""
    return builder.inttoptr(address, kind.as_pointer())


def typed_step(typing: Compiler, function: Compiler, space: Compiler, timestep: Compiler) -> Compiler:
    """Return signature and code generator of `step_space`."""

    def generate(context: Compiler, builder: Compiler, signature: Compiler, arguments: Compiler) -> Compiler:
        kind = IR.FunctionType(IR.VoidType(), [LLVM.voidptr_t, IR.DoubleType()])
        called = pointer_to(builder, arguments[0], kind)
        builder.call(called, [builder.inttoptr(arguments[1], LLVM.voidptr_t), arguments[2]])
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.float64), generate


def typed_each(
    typing: Compiler, function: Compiler, space: Compiler, visitor: Compiler, data: Compiler, done: Compiler
) -> Compiler:
    """Return signature and code generator of `each_body`."""

    def generate(context: Compiler, builder: Compiler, signature: Compiler, arguments: Compiler) -> Compiler:
        builder.store(LLVM.int32_t(0), pointer_to(builder, arguments[4], LLVM.int32_t))
        called = pointer_to(builder, arguments[0], IR.FunctionType(IR.VoidType(), [LLVM.voidptr_t] * 3))
        builder.call(called, [builder.inttoptr(argument, LLVM.voidptr_t) for argument in arguments[1:4]])
        return context.get_dummy_value()

    return types.void(*[types.int64] * 5), generate


step_instruction: Compiler = intrinsic(typed_step)
each_instruction: Compiler = intrinsic(typed_each)


@overload(step_space, inline="always")
def compiled_step(function: Compiler, space: Compiler, timestep: Compiler) -> Compiler:
    """Return the implementation of `step_space` in compiled code."""

    def compiled(function: Compiler, space: Compiler, timestep: Compiler) -> None:
        step_instruction(function, space, timestep)

    return compiled


@overload(each_body, inline="always")
def compiled_each(function: Compiler, space: Compiler, visitor: Compiler, data: Compiler, done: Compiler) -> Compiler:
    """Return the implementation of `each_body` in compiled code."""

    def compiled(function: Compiler, space: Compiler, visitor: Compiler, data: Compiler, done: Compiler) -> None:
        each_instruction(function, space, visitor, data, done)

    return compiled


@inlined
def touch(world: int, handles: Ints, current: bool, timestep: float) -> None:
    """Run a substep of a world in Chipmunk: load bodies unless `current`, write forces, step, read bodies back."""
    space, each = handles[world, SPACE], handles[world, EACH]
    if not current:
        each_body(each, space, handles[world, WRITE_BODY], handles[world, BODIES], handles[world, BODIES_DONE])
    each_body(each, space, handles[world, WRITE_BODY], handles[world, FORCES], handles[world, FORCES_DONE])
    step_space(handles[world, STEP], space, timestep)
    each_body(each, space, handles[world, READ_BODY], handles[world, BODIES], handles[world, BODIES_DONE])
