"""Spaces: where positions live and what an offset between two of them is."""

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.parameters import check_choice, positive


class Space:
    """A space of 2 or 3 dimensions: `Euclidean` or `Torus`.

    `wrap` brings positions into [0, extent) once, when they enter. Two positions then differ by less than one extent,
    and compiled code finds the shortest image by a comparison instead of a division.
    """

    def __init__(self, extent: Floats) -> None:
        self.extent = extent  # (D,) float64 [m], 0 = the axis is open
        self.dim = len(extent)
        self.padded_extent = np.zeros(3)  # (3,) float64 [m], for kernels: always three components
        self.padded_extent[: self.dim] = extent

    def wrap(self, positions: Floats) -> Floats:
        """Return a copy of positions (..., D) [m] with every closed axis brought into [0, extent)."""
        inside: Floats = np.array(positions, dtype=np.float64, order="C")
        wrap_all(inside.reshape(-1, self.dim), self.extent)
        return inside

    def offsets(self, origin: Floats, target: Floats) -> Floats:
        """Return the shortest way (..., D) [m] from `origin` (..., D) to `target` (..., D)."""
        delta = self.wrap(target) - self.wrap(origin)
        ways: Floats = np.ascontiguousarray(delta)
        shorten(ways.reshape(-1, self.dim), self.extent)
        return ways


class Euclidean(Space):
    """Open space of `dim` 2 or 3 dimensions."""

    def __init__(self, dim: int = 2) -> None:
        check_choice("Euclidean: dim", dim, (2, 3))
        super().__init__(np.zeros(dim))


class Torus(Space):
    """Plane of `width` x `height` [m] whose opposite edges are one."""

    def __init__(self, width: float, height: float) -> None:
        for name, value in (("width", width), ("height", height)):
            positive(self, name, value)
        super().__init__(np.array([width, height], dtype=np.float64))


@inlined
def half_of(extent: float) -> float:
    """Return half the length [m] of a closed axis, infinity for an open one (extent 0)."""
    return 0.5 * extent if extent > 0.0 else np.inf


@inlined
def shortest(delta: float, extent: float, half: float) -> float:
    """Return the shortest of the images of `delta` [m], |delta| < extent; `half` is `half_of(extent)`.

    Loops over many offsets use this function, because they compute `half` once, before the loop.
    """
    if delta > half:
        return delta - extent
    if delta < -half:
        return delta + extent
    return delta


@inlined
def nearest_image(delta: float, extent: float) -> float:
    """Return the shortest of the images of `delta` [m] on an axis of `extent` [m] (0: open), |delta| < extent."""
    return shortest(delta, extent, half_of(extent))


@inlined
def squared_length(dx: float, dy: float, dz: float, extent: Floats) -> float:
    """Return the squared length [m2] of the shortest image of an offset [m] in a space of `extent` (3,) [m]."""
    x, y, z = nearest_image(dx, extent[0]), nearest_image(dy, extent[1]), nearest_image(dz, extent[2])
    return x * x + y * y + z * z


@lean_kernel
def shorten(deltas: Floats, extent: Floats) -> None:
    """Replace each of `deltas` (M, D) [m] by its shortest image in a space of `extent` (D,) [m]."""
    for index in range(len(deltas)):
        for axis in range(len(extent)):
            deltas[index, axis] = nearest_image(deltas[index, axis], extent[axis])


@lean_kernel
def wrap_all(positions: Floats, extent: Floats) -> None:
    """Bring `positions` (M, D) [m] into a space of `extent` (D,) [m]."""
    for index in range(len(positions)):
        for axis in range(len(extent)):
            positions[index, axis] = wrapped(positions[index, axis], extent[axis])


@inlined
def wrapped(coordinate: float, extent: float) -> float:
    """Return `coordinate` [m] brought into [0, extent), unchanged on an open axis (extent 0)."""
    if extent > 0.0 and (coordinate < 0.0 or coordinate >= extent):
        inside = coordinate - extent * np.floor(coordinate / extent)
        return inside if 0.0 <= inside < extent else 0.0  # the quotient may have been rounded across a whole number
    return coordinate
