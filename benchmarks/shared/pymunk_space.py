"""One world of pymunk: discs that touch, and their copies across the seams, by pymunk's cheapest calls.

Shapes: N robots a world, R = W * N rows.
"""

from math import inf
from typing import Any, Final

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import ffi, lib

from clean_swarm_env.physics.chipmunk_calls import COLLISION_SLOP
from clean_swarm_env.physics.contact_space import COPIES
from clean_swarm_env.physics.motion import COPY_OFFSETS, SKIN
from clean_swarm_env.physics.physics import PhysicsSettings
from selforg.arrays import Flags, Floats
from selforg.compiler.decorators import kernel
from selforg.space import wrapped

ORIGINALS: Final = pymunk.ShapeFilter(categories=0b01, mask=0b11)


class PymunkSpace:
    """One world in pymunk: N discs without rotation, and their seam copies.

    `load` writes `bodies` (N, 4) float64 x, y, vx, vy [m, m/s] to pymunk. `step` applies `forces` (N, 2) float64 [N]
    and reads `bodies` back. Both arrays are C-contiguous; pymunk reads and writes them itself.
    """

    def __init__(self, settings: PhysicsSettings, bodies: Floats, forces: Floats) -> None:
        self._size, self._radius = (settings.width, settings.height), settings.radius * (1.0 + SKIN)
        self._space = pymunk.Space()
        self._space.collision_slop = COLLISION_SLOP
        self._discs = [pymunk.Body(1.0, inf) for _ in range(settings.robots)]
        self._present = np.zeros((settings.robots, len(COPY_OFFSETS)), np.bool_)
        self._shapes: dict[tuple[int, int], pymunk.Circle] = {}  # (row, number of the offset) -> copy, kept once made
        for disc in self._discs:
            circle = pymunk.Circle(disc, self._radius)
            circle.filter = ORIGINALS
            self._space.add(disc, circle)
        self._write = ffi.addressof(lib, "pmSpaceBodySetIteratorFuncBatched")
        self._read = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
        self._whole = _channel(bodies, lib.POSITION | lib.VELOCITY)
        self._force = _channel(forces, lib.FORCE)

    def load(self) -> None:
        """Take positions and velocities from the array `bodies`."""
        self._exchange(self._write, self._whole)

    def step(self, timestep: float) -> None:
        """Move by the present velocities, then change them by forces and contacts; leaves both in `bodies`."""
        self._exchange(self._write, self._force)
        lib.cpSpaceStep(self._space._space, timestep)
        self._exchange(self._read, self._whole)

    def set_copies(self, needed: Flags) -> None:
        """Add and remove seam copies until each body has those that are `needed` (N, 4)."""
        if (needed == self._present).all():
            return
        for row, number in np.argwhere(needed != self._present).tolist():
            if needed[row, number]:
                self._space.add(self._copy(row, number))
            else:
                self._space.remove(self._shapes[row, number])
        self._present[:] = needed

    def _copy(self, row: int, number: int) -> pymunk.Circle:
        if (row, number) not in self._shapes:
            right, up = COPY_OFFSETS[number]
            circle = pymunk.Circle(self._discs[row], self._radius, (right * self._size[0], up * self._size[1]))
            circle.filter = COPIES
            self._shapes[row, number] = circle
        return self._shapes[row, number]

    def _exchange(self, direction: object, channel: tuple[Any, Any]) -> None:
        buffer, request = channel
        buffer.num = 0
        lib.cpSpaceEachBody(self._space._space, direction, request)


def _channel(array: NDArray[np.float64], fields: int) -> tuple[Any, Any]:
    """Return a C-contiguous float64 array as pymunk's batch buffer, and the request that names its fields."""
    buffer = ffi.new("pmFloatArray *")
    buffer.arr = ffi.cast("cpFloat *", array.ctypes.data)
    # The buffer has room beyond the end, never written: pymunk reallocates a full buffer, but NumPy owns this one.
    buffer.max = array.size + 16
    request = ffi.new("pmBatchedData *")
    request.fields, request.floatArray, request.intArray = fields, buffer, ffi.NULL
    return buffer, request


@kernel
def wrap_bodies(bodies: Floats, width: float, height: float) -> bool:
    """Put bodies (R, 4) into [0, width) x [0, height) [m]; return whether any crossed a seam."""
    crossed = False
    for row in range(bodies.shape[0]):
        x, y = wrapped(bodies[row, 0], width), wrapped(bodies[row, 1], height)
        crossed = crossed or x != bodies[row, 0] or y != bodies[row, 1]
        bodies[row, 0], bodies[row, 1] = x, y
    return crossed


@kernel
def find_copies(bodies: Floats, width: float, height: float, zone: float, needed: Flags) -> None:
    """Note which seam copies bodies (R, 4) within `zone` [m] of a seam need: (R, 4), see COPY_OFFSETS."""
    for row in range(bodies.shape[0]):
        left, below, above = bodies[row, 0] < zone, bodies[row, 1] < zone, bodies[row, 1] > height - zone
        needed[row, 0], needed[row, 1] = left, below
        needed[row, 2], needed[row, 3] = left and below, left and above


@kernel
def push_bodies(bodies: Floats, wanted: Floats, timestep: float, forces: Floats) -> None:
    """Set the forces (R, 2) [N] on bodies of 1 kg that give the wanted velocities (R, 2) [m/s] in one timestep."""
    for row in range(bodies.shape[0]):
        forces[row, 0] = (wanted[row, 0] - bodies[row, 2]) / timestep
        forces[row, 1] = (wanted[row, 1] - bodies[row, 3]) / timestep
