"""Ground that robots have seen: covered area and time since each place was seen, on a grid of cells.

A cell is seen while its middle lies within the sight of a robot. Shapes: W worlds, N robots a world, R = W * N,
G x G cells.
"""

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import kernel

UNSEEN = -1.0
"""Time of a cell that was never seen."""


def area(seen: Floats, pitch: float) -> Floats:
    """Return the area seen so far (maps,) [m2] of maps (maps, G, G) whose cells have a side `pitch` [m]."""
    count: Floats = (seen > UNSEEN).sum(axis=(1, 2)) * pitch**2
    return count


def idleness(seen: Floats, now: Floats) -> Floats:
    """Return the mean time (maps,) [s] since places were seen, at `now` (maps,); unseen places count from 0 s on."""
    idle: Floats = now - np.maximum(seen, 0.0).mean(axis=(1, 2))
    return idle


@kernel
def mark(
    positions: Floats, maps: Ints, now: Floats, corner: Floats, sight: float, pitch: float, closed: bool, seen: Floats
) -> None:
    """Write `now` (R,) [s] into the cells of `seen` (maps, G, G) whose middles are within `sight` of positions (R, 2).

    Row k draws on the map `maps` (R,) of that number. corner: (2,) lower left corner of the maps [m]. closed: whether
    opposite edges are one.
    """
    cells = seen.shape[1]
    for row in range(positions.shape[0]):
        x, y = (positions[row, 0] - corner[0]) / pitch - 0.5, (positions[row, 1] - corner[1]) / pitch - 0.5
        radius = sight / pitch
        for j in range(int(np.ceil(y - radius)), int(np.floor(y + radius)) + 1):
            half = np.sqrt(max(radius * radius - (j - y) * (j - y), 0.0))
            for i in range(int(np.ceil(x - half)), int(np.floor(x + half)) + 1):
                if closed:
                    seen[maps[row], j % cells, i % cells] = now[row]
                elif 0 <= i < cells and 0 <= j < cells:
                    seen[maps[row], j, i] = now[row]
