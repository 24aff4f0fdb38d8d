"""Small kernels between deciding and driving: who runs what, and the way to a station."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from selforg.compiler.decorators import lean_kernel
from selforg.network.state import state as st
from selforg.space import nearest_image

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@lean_kernel
def rows_running(marks: Ints, behaviours: Ints, rows: Ints, counts: Ints) -> None:
    """List where each of `behaviours` (K,) of a network with `marks` runs in `rows` (K, R), `counts` (K,) of them."""
    for k in range(behaviours.shape[0]):
        count = 0
        for row in range(marks.shape[0]):
            if marks[row, st.EXECUTING, behaviours[k]]:
                rows[k, count] = row
                count += 1
        counts[k] = count


@lean_kernel
def to_stations(
    marks: Ints, behaviours: Ints, robots: Floats, extent: Floats, stations: Floats, vectors: Floats, commanded: Flags
) -> None:
    """Write unit vectors (R, 2) towards a station where the behaviour that goes there runs.

    marks: of the network; `behaviours` (K,) of it go to `stations` (W, K, 2) [m]. robots (R, 2) and extent (2,) [m].
    commanded (R,): set where a vector was written.
    """
    per_world = robots.shape[0] // stations.shape[0]
    for row in range(robots.shape[0]):
        world = row // per_world
        for k in range(behaviours.shape[0]):
            if marks[row, st.EXECUTING, behaviours[k]]:
                x = nearest_image(stations[world, k, 0] - robots[row, 0], extent[0])
                y = nearest_image(stations[world, k, 1] - robots[row, 1], extent[1])
                length = np.sqrt(x * x + y * y)
                vectors[row, 0] = x / length if length > 0.0 else 0.0
                vectors[row, 1] = y / length if length > 0.0 else 0.0
                commanded[row] = True


@lean_kernel
def begin_acting(
    marks: Ints, transport: Ints, movers: Ints, robots: Floats, extent: Floats, stations: Floats, vectors: Floats,
    commanded: Flags, in_place: Flags, rows: Ints, counts: Ints,
) -> None:  # fmt: skip
    """Forget the commands of the tick before, and do what needs no mechanism: ways to stations, lists of who moves."""
    for row in range(commanded.shape[0]):
        commanded[row] = False
        in_place[row] = False
    to_stations(marks, transport, robots, extent, stations, vectors, commanded)
    rows_running(marks, movers, rows, counts)
