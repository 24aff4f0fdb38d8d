"""Calls of Chipmunk's C functions by address from compiled code: they move a world in contact for one control tick.

A call from Python costs about as much as the work of a small space. `contact_space.py` has the addresses, and does the
same through pymunk's public interface where compiled code cannot call C.

A space lives for one tick at most. What Chipmunk keeps from step to step (impulses, corrections of overlaps, the order
in which it meets contacts) is therefore no part of the state of a world, and a copy of the arrays is a copy of it
(docs/decisions/0070-a-space-a-tick.md).
"""

from typing import Annotated, NamedTuple

import numpy as np
from numba import types
from numba.extending import intrinsic, overload

from clean_swarm_env.physics.motion import COPY_OFFSETS, NOBODY_TOUCHES, RobotMotion, choose_walls, open_robot_motion
from selforg.arrays import READ, Ints
from selforg.compiler.decorators import part
from selforg.compiler.intrinsics import LLVM, Compiler
from selforg.compiler.records import Handle, Written, opening
from selforg.compiler.switches import LEAN
from selforg.walls.segments import Walls, open_walls

IR: Compiler = LLVM.ir
TYPES: Compiler = types  # they have no types themselves

COLLISION_SLOP = 0.005  # [m]; Chipmunk's own 0.1 would let discs of 0.25 m sink in visibly
COPY_CATEGORY, COPY_MASK = 0b10, 0b01  # seam copies meet originals only, so that each pair meets once
WALL_CATEGORY, WALL_MASK = 0b100, 0b01  # walls meet originals only; they have images across the seams themselves
ROBOT_CATEGORY = 0b01  # of robots that pass through each other: they meet walls only

NAMES = (
    "cpSpaceNew", "cpSpaceFree", "cpSpaceSetCollisionSlop", "cpSpaceAddBody", "cpSpaceAddShape", "cpSpaceStep",
    "cpBodyNew", "cpBodyFree", "cpBodySetPosition", "cpBodySetVelocity", "cpBodySetForce", "cpBodyGetPosition",
    "cpBodyGetVelocity", "cpBodyUpdatePosition", "cpCircleShapeNew", "cpShapeFree", "cpShapeSetFilter",
    "cpSpaceGetStaticBody", "cpSegmentShapeNew",
)  # fmt: skip
(
    SPACE_NEW, SPACE_FREE, SET_SLOP, ADD_BODY, ADD_SHAPE, SPACE_STEP, BODY_NEW, BODY_FREE, SET_POSITION, SET_VELOCITY,
    SET_FORCE, GET_POSITION, GET_VELOCITY, UPDATE_POSITION, CIRCLE_NEW, SHAPE_FREE, SET_FILTER, STATIC_BODY,
    SEGMENT_NEW,
) = range(len(NAMES))  # fmt: skip


class Chipmunk(NamedTuple):
    """The addresses of Chipmunk's functions in the memory of this process."""

    functions: Annotated[Ints, "NAMES", READ]  # all zero where compiled code cannot call them


open_chipmunk = opening(Chipmunk)


def call_c(function: int, arguments: tuple[float, ...]) -> None:
    """Call the C function at an address; in compiled code only.

    Whole numbers are passed as pointers or integers, others as doubles; a `cpVect` is passed as its two doubles.
    """
    raise NotImplementedError("C functions are called from compiled code only")


def call_for_pointer(function: int, arguments: tuple[float, ...]) -> int:
    """Call a C function that returns a pointer; in compiled code only."""
    raise NotImplementedError("C functions are called from compiled code only")


def call_for_vector(function: int, arguments: tuple[float, ...]) -> tuple[float, float]:
    """Call a C function that returns a `cpVect`; in compiled code only."""
    raise NotImplementedError("C functions are called from compiled code only")


VECTOR = IR.LiteralStructType([IR.DoubleType(), IR.DoubleType()])
RESULTS = {
    call_c: (types.void, IR.VoidType()),
    call_for_pointer: (types.int64, IR.IntType(64)),
    call_for_vector: (TYPES.UniTuple(types.float64, 2), VECTOR),
}


def compile_calls(caller: Compiler) -> None:
    """Give one of the callers above its code."""
    result, kind = RESULTS[caller]

    def typed(typing: Compiler, function: Compiler, arguments: Compiler) -> Compiler:
        doubles = [argument == types.float64 for argument in arguments]

        def generate(context: Compiler, builder: Compiler, signature: Compiler, given: Compiler) -> Compiler:
            kinds = [IR.DoubleType() if double else IR.IntType(64) for double in doubles]
            called = builder.inttoptr(given[0], IR.FunctionType(kind, kinds).as_pointer())
            values = [builder.extract_value(given[1], index) for index in range(len(kinds))]
            returned = builder.call(called, values)
            if caller is call_c:
                return context.get_dummy_value()
            if caller is call_for_pointer:
                return returned
            return context.make_tuple(builder, result, [builder.extract_value(returned, axis) for axis in range(2)])

        return result(types.int64, arguments), generate

    instruction: Compiler = intrinsic(typed)

    @overload(caller, jit_options=dict(LEAN))  # type: ignore[arg-type]  # (keys that Numba does not declare)
    def compiled(function: Compiler, arguments: Compiler) -> Compiler:
        def implementation(function: Compiler, arguments: Compiler) -> Compiler:
            return instruction(function, arguments)

        return implementation


for each in RESULTS:
    compile_calls(each)


@part
def make_space(world: int, motion: Handle[RobotMotion], walls: Handle[Walls], chipmunk: Handle[Chipmunk]) -> int:
    """Return the address of a new space that holds the discs of a world, in the order of their rows, and near walls.

    Absent robots lie in it and touch no other, so that the others are computed as they were.
    """
    c, m = open_chipmunk(chipmunk).functions, open_robot_motion(motion)
    space = call_for_pointer(c[SPACE_NEW], ())
    call_c(c[SET_SLOP], (space, COLLISION_SLOP))
    for index in range(m.parts.shape[0]):
        row, disc = world * m.parts.shape[0] + index, call_for_pointer(c[BODY_NEW], (1.0, np.inf))
        call_c(c[SET_POSITION], (disc, m.bodies[row, 0], m.bodies[row, 1]))  # else all circles would be pairs
        m.parts[index, 0] = call_for_pointer(c[ADD_BODY], (space, disc))
        circle = call_for_pointer(c[CIRCLE_NEW], (disc, m.radii[row], 0.0, 0.0))
        if not m.present[row]:
            call_c(c[SET_FILTER], (circle, 0, 0))
        elif m.search == NOBODY_TOUCHES:
            call_c(c[SET_FILTER], (circle, 0, ROBOT_CATEGORY | WALL_CATEGORY << 32))
        m.parts[index, 1] = call_for_pointer(c[ADD_SHAPE], (space, circle))
    if m.walls.shape[0] > 0:
        choose_walls(world, motion, walls)
        add_walls(space, motion, walls, chipmunk)
    return space


@part
def add_walls(space: int, motion: Handle[RobotMotion], walls: Handle[Walls], chipmunk: Handle[Chipmunk]) -> None:
    """Put the chosen walls into a space."""
    c, m, w = open_chipmunk(chipmunk).functions, open_robot_motion(motion), open_walls(walls)
    body = call_for_pointer(c[STATIC_BODY], (space,))
    for k in range(m.walls.shape[0]):
        if m.walls[k] != 0:
            ends = (body, w.segments[k, 0], w.segments[k, 1], w.segments[k, 2], w.segments[k, 3], 0.0)
            wall = call_for_pointer(c[SEGMENT_NEW], ends)
            call_c(c[SET_FILTER], (wall, 0, WALL_CATEGORY | WALL_MASK << 32))
            m.walls[k] = call_for_pointer(c[ADD_SHAPE], (space, wall))


@part
def touch(world: int, space: int, last: bool, motion: Written[RobotMotion], chipmunk: Handle[Chipmunk]) -> None:
    """Run a substep of a world in Chipmunk: write `bodies` and `forces`, step, and read `bodies` back.

    Chipmunk corrects overlaps when it moves bodies in its next step. After the `last` step of a space they are
    corrected at once.
    """
    c, m = open_chipmunk(chipmunk).functions, open_robot_motion(motion)
    robots = m.parts.shape[0]
    for index in range(robots):
        row, disc = world * robots + index, m.parts[index, 0]
        call_c(c[SET_POSITION], (disc, m.bodies[row, 0], m.bodies[row, 1]))
        call_c(c[SET_VELOCITY], (disc, m.bodies[row, 2], m.bodies[row, 3]))
        call_c(c[SET_FORCE], (disc, m.forces[row, 0], m.forces[row, 1]))
        for bit in range(4):
            if m.copies[row] & (1 << bit) and m.parts[index, 2 + bit] == 0:
                x, y = COPY_OFFSETS[bit][0] * m.width, COPY_OFFSETS[bit][1] * m.height
                circle = call_for_pointer(c[CIRCLE_NEW], (disc, m.radii[row], x, y))
                call_c(c[SET_FILTER], (circle, 0, COPY_CATEGORY | COPY_MASK << 32))
                m.parts[index, 2 + bit] = call_for_pointer(c[ADD_SHAPE], (space, circle))
    call_c(c[SPACE_STEP], (space, m.timestep))
    for index in range(robots):
        row, disc = world * robots + index, m.parts[index, 0]
        m.bodies[row, 2], m.bodies[row, 3] = call_for_vector(c[GET_VELOCITY], (disc,))
        if last:
            call_c(c[SET_VELOCITY], (disc, 0.0, 0.0))
            call_c(c[UPDATE_POSITION], (disc, m.timestep))
        m.bodies[row, 0], m.bodies[row, 1] = call_for_vector(c[GET_POSITION], (disc,))


@part
def free_space(space: int, motion: Handle[RobotMotion], chipmunk: Handle[Chipmunk]) -> None:
    """Free the memory of a space, its discs, circles and walls."""
    c, m = open_chipmunk(chipmunk).functions, open_robot_motion(motion)
    call_c(c[SPACE_FREE], (space,))
    for index in range(m.parts.shape[0]):
        for column in range(1, m.parts.shape[1]):
            if m.parts[index, column] != 0:
                call_c(c[SHAPE_FREE], (m.parts[index, column],))
        call_c(c[BODY_FREE], (m.parts[index, 0],))
        m.parts[index] = 0
    for k in range(m.walls.shape[0]):
        if m.walls[k] != 0:
            call_c(c[SHAPE_FREE], (m.walls[k],))
            m.walls[k] = 0
