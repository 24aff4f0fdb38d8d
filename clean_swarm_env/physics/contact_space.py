"""Pymunk: addresses of its C functions, and the same calls by its public interface. No other file imports pymunk."""

import os
from math import inf
from typing import Final

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from clean_swarm_env.physics.chipmunk_calls import (
    COLLISION_SLOP,
    COPY_CATEGORY,
    COPY_MASK,
    NAMES,
    ROBOT_CATEGORY,
    WALL_CATEGORY,
    WALL_MASK,
    Chipmunk,
)
from clean_swarm_env.physics.motion import COPY_OFFSETS, NOBODY_TOUCHES, RobotMotion, choose_walls
from selforg.compiler.records import Packed
from selforg.compiler.switches import COMPILED, PLAIN
from selforg.walls.segments import Walls

CALLED: Final = COMPILED and not PLAIN and os.name == "posix"
"""Whether compiled code calls Chipmunk. Windows passes vectors to C functions in another way."""

COPIES: Final = pymunk.ShapeFilter(categories=COPY_CATEGORY, mask=COPY_MASK)
UNTOUCHED: Final = pymunk.ShapeFilter(categories=0, mask=0)
PASSING: Final = pymunk.ShapeFilter(categories=ROBOT_CATEGORY, mask=WALL_CATEGORY)
WALL: Final = pymunk.ShapeFilter(categories=WALL_CATEGORY, mask=WALL_MASK)


def chipmunk_functions(called: bool = CALLED) -> Packed[Chipmunk]:
    """Return the addresses of Chipmunk's functions in this process, zeros where Python makes the calls."""
    found = [int(ffi.cast("intptr_t", ffi.addressof(lib, name))) if called else 0 for name in NAMES]
    return Packed(Chipmunk(np.array(found)))


class ContactSpace:
    """The robots of one world in pymunk for one control tick: discs without rotation, their seam copies, near walls.

    `touch` is `chipmunk_calls.touch`, by pymunk's public interface: the same bits, but slower.
    """

    def __init__(self, world: int, packed: Packed[RobotMotion], walls: Packed[Walls]) -> None:
        motion = self._motion = packed.record
        self._first = world * len(motion.parts)
        self._space = pymunk.Space()
        self._space.collision_slop = COLLISION_SLOP
        self._discs = [pymunk.Body(1.0, inf) for _ in motion.parts]
        self._copied = [0] * len(motion.parts)  # copy bits that each disc has
        for row, disc in enumerate(self._discs, self._first):
            disc.position = tuple(motion.bodies[row, :2].tolist())
            circle = pymunk.Circle(disc, float(motion.radii[row]))
            if not motion.present[row]:
                circle.filter = UNTOUCHED
            elif motion.search == NOBODY_TOUCHES:
                circle.filter = PASSING
            self._space.add(disc, circle)
        choose_walls(world, packed.handle, walls.handle)
        for ax, ay, bx, by in walls.record.segments[motion.walls != 0].tolist():
            wall = pymunk.Segment(self._space.static_body, (ax, ay), (bx, by), 0.0)
            wall.filter = WALL
            self._space.add(wall)
        motion.walls[:] = 0

    def touch(self, last: bool) -> None:
        """Run a substep; see `chipmunk_calls.touch`."""
        m = self._motion
        for index, disc in enumerate(self._discs):
            x, y, vx, vy = m.bodies[self._first + index].tolist()
            disc.position, disc.velocity = (x, y), (vx, vy)
            fx, fy = m.forces[self._first + index].tolist()
            disc.force = (fx, fy)
            self._copy(index)
        self._space.step(m.timestep)
        for row, disc in enumerate(self._discs, self._first):
            m.bodies[row, 2:] = disc.velocity
            if last:
                disc.velocity = (0.0, 0.0)
                pymunk.Body.update_position(disc, m.timestep)
            m.bodies[row, :2] = disc.position

    def _copy(self, index: int) -> None:
        """Add the seam copies that a disc needs and does not have."""
        needed, disc = int(self._motion.copies[self._first + index]), self._discs[index]
        for bit, (right, up) in enumerate(COPY_OFFSETS):
            if needed & ~self._copied[index] & 1 << bit:
                offset = (right * self._motion.width, up * self._motion.height)
                circle = pymunk.Circle(disc, float(self._motion.radii[self._first + index]), offset)
                circle.filter = COPIES
                self._space.add(circle)
        self._copied[index] |= needed
