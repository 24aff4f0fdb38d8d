"""One world of pymunk: discs that touch, and their copies across the seams (the only file that knows pymunk)."""

from math import inf
from typing import Any, Final

import numpy as np
import pymunk
from numpy.typing import NDArray

from clean_swarm_env.physics import chipmunk_calls as calls
from clean_swarm_env.physics.motion import COPY_ABOVE, COPY_RIGHT, COPY_RIGHT_ABOVE, COPY_RIGHT_BELOW
from clean_swarm_env.physics.settings import PhysicsSettings
from clean_swarm_env.physics.uncopied import Uncopied
from selforg.arrays import Floats
from selforg.compiler.switches import COMPILED, PLAIN

try:  # Pymunk's C calls; `pymunk.batch` makes the same calls, but allocates at every call.
    from pymunk._chipmunk_cffi import ffi, lib
except ImportError:  # A pymunk without them: its public interface gives the same bits, but is slower.
    ffi = lib = None

SHARED_MEMORY: Final = hasattr(lib, "pmSpaceBodySetIteratorFuncBatched")
COLLISION_SLOP: Final = 0.005  # [m]; Chipmunk's own 0.1 would let discs of 0.25 m sink in visibly
SKIN: Final = 1e-9  # share of the radius added: robots exactly two radii apart touch in spite of rounding
PERSISTENCE: Final = 3  # [substeps] for which Chipmunk remembers a contact
ORIGINALS: Final = pymunk.ShapeFilter(categories=0b01, mask=0b11)
UNTOUCHED: Final = pymunk.ShapeFilter(categories=0, mask=0)
COPY_OFFSETS: Final = {
    COPY_RIGHT: (1, 0),
    COPY_ABOVE: (0, 1),
    COPY_RIGHT_ABOVE: (1, 1),
    COPY_RIGHT_BELOW: (1, -1),
}  # copy bit -> offset in world sizes


class ContactSpace(Uncopied):
    """One world in pymunk: N discs without rotation, and their seam copies.

    `load` writes `bodies` (N, 4) float64 x, y, vx, vy [m, m/s] to pymunk. `step` applies `forces` (N, 2) float64 [N]
    and reads `bodies` back. Both arrays are C-contiguous and stay the same objects. With `shared_memory` pymunk reads
    and writes the arrays itself. Without it each attribute goes through the public interface: same bits, but slower.
    """

    def __init__(
        self,
        settings: PhysicsSettings,
        bodies: Floats,
        forces: Floats,
        shared_memory: bool = SHARED_MEMORY,
    ) -> None:
        self._bodies, self._forces = bodies, forces
        self._settings = settings
        self._radius = settings.radius * (1.0 + SKIN)
        self._present = bytes(settings.robots)  # (N,) copy bits each body has now
        self._space = pymunk.Space()
        self._space.collision_slop = COLLISION_SLOP
        self._space.collision_persistence = PERSISTENCE
        self._discs = [pymunk.Body(settings.mass, inf) for _ in range(settings.robots)]
        self._shapes: dict[tuple[int, int], pymunk.Circle] = {}  # (row, copy bit) -> copy, kept once made
        self._circles = [pymunk.Circle(disc, self._radius) for disc in self._discs]
        for disc, circle in zip(self._discs, self._circles, strict=True):
            circle.filter = ORIGINALS
            self._space.add(disc, circle)
        self._shared_memory = shared_memory
        if shared_memory:
            self._write = ffi.addressof(lib, "pmSpaceBodySetIteratorFuncBatched")
            self._read = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
            self._whole = _channel(bodies, lib.POSITION | lib.VELOCITY)
            self._force = _channel(forces, lib.FORCE)

    def handles(self) -> list[int]:
        """Return the row of `chipmunk_calls` for this space, zeros where compiled code cannot call pymunk."""
        if not self._shared_memory or not COMPILED or PLAIN:
            return [0] * calls.HANDLES
        step, each = ffi.addressof(lib, "cpSpaceStep"), ffi.addressof(lib, "cpSpaceEachBody")
        pointers = [self._space._space, step, each, self._write, self._read]
        for numbers, request in (self._whole, self._force):
            pointers += [request, ffi.addressof(numbers, "num")]
        return [int(ffi.cast("intptr_t", pointer)) for pointer in pointers]

    def load(self) -> None:
        """Take positions and velocities from the array `bodies`."""
        if self._shared_memory:
            self._exchange(self._write, self._whole)
            return
        for disc, (x, y, vx, vy) in zip(self._discs, self._bodies.tolist(), strict=True):
            disc.position, disc.velocity = (x, y), (vx, vy)

    def step(self, timestep: float) -> None:
        """Move by the present velocities, then change them by forces and contacts; leaves both in `bodies`."""
        if self._shared_memory:
            self._exchange(self._write, self._force)
            lib.cpSpaceStep(self._space._space, timestep)
            self._exchange(self._read, self._whole)
            return
        for disc, (fx, fy) in zip(self._discs, self._forces.tolist(), strict=True):
            disc.force = (fx, fy)
        self._space.step(timestep)
        for row, disc in enumerate(self._discs):
            self._bodies[row] = (*disc.position, *disc.velocity)

    def let_touch(self, row: int, wanted: bool) -> None:
        """Make a disc touch others, or not. It stays in the space, so that the others are computed as before."""
        self._circles[row].filter = ORIGINALS if wanted else UNTOUCHED

    def set_copies(self, copies: NDArray[np.uint8]) -> None:
        """Add and remove seam copies until each body has those that `copies` (N,) names."""
        needed = copies.tobytes()
        if needed == self._present:
            return
        changed = np.flatnonzero(copies != np.frombuffer(self._present, np.uint8)).tolist()
        for row in changed:
            for bit in COPY_OFFSETS:
                if needed[row] & ~self._present[row] & bit:
                    self._add_copy(row, bit)
                elif self._present[row] & ~needed[row] & bit:
                    self._space.remove(self._shapes[row, bit])
        self._present = needed

    def _add_copy(self, row: int, bit: int) -> None:
        if (row, bit) not in self._shapes:
            right, up = COPY_OFFSETS[bit]
            offset = (right * self._settings.width, up * self._settings.height)
            circle = pymunk.Circle(self._discs[row], self._radius, offset)
            circle.filter = pymunk.ShapeFilter(categories=0b10, mask=0b01)
            self._shapes[row, bit] = circle
        self._space.add(self._shapes[row, bit])

    def _exchange(self, direction: object, channel: tuple[Any, Any]) -> None:
        buffer, request = channel
        buffer.num = 0
        lib.cpSpaceEachBody(self._space._space, direction, request)


def _channel(array: Floats, fields: int) -> tuple[Any, Any]:
    """Return a C-contiguous float64 array as pymunk's batch buffer, and the request that names its fields."""
    buffer = ffi.new("pmFloatArray *")
    buffer.arr = ffi.cast("cpFloat *", array.ctypes.data)
    # The buffer has room beyond the end, never written: pymunk reallocates a full buffer, but NumPy owns this one.
    buffer.max = array.size + 16
    request = ffi.new("pmBatchedData *")
    request.fields, request.floatArray, request.intArray = fields, buffer, ffi.NULL
    return buffer, request
