"""Ground that robots have seen: covered area and time since each place was seen, on a grid of cells.

A cell is seen while its middle lies within the sight of a robot. Shapes: W worlds, N robots a world, R = W * N,
G x G cells.
"""

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import kernel

UNSEEN = -1.0
"""Time of a cell that was never seen."""


class Coverage:
    """Time at which each cell was last seen, by any robot of a world, or by each robot on its own.

    Args:
        rows_of: (R,) number of the map on which each robot draws: that of its world, or its own.
        side: side of the square that is mapped [m]; `corner` is its lower left corner, x and y alike [m].
        sight: radius within which robots see [m].
        pitch: side of a cell [m]; the side must be a whole number of cells.
        closed: whether opposite edges of the square are one.

    Attributes:
        seen: (maps, G, G) time [s], UNSEEN where no robot looked.

    """

    def __init__(self, rows_of: Ints, side: float, corner: float, sight: float, pitch: float, closed: bool) -> None:
        cells = round(side / pitch)
        if cells < 1 or abs(cells * pitch - side) > 1e-6:
            raise ValueError(f"Coverage: side {side:g} m is no whole number of cells of {pitch:g} m")
        self._maps, self._corner, self._sight, self._pitch, self._closed = rows_of, corner, sight, pitch, closed
        self.seen: Floats = np.full((int(rows_of.max()) + 1, cells, cells), UNSEEN)

    def look(self, positions: Floats, now: float) -> None:
        """Mark the cells that robots at positions (R, 2) [m] see at `now` [s]."""
        mark(positions, self._maps, now, self._corner, self._sight, self._pitch, self._closed, self.seen)

    @property
    def area(self) -> Floats:
        """Area seen so far (maps,) [m2]."""
        count: Floats = (self.seen > UNSEEN).sum(axis=(1, 2)) * self._pitch**2
        return count

    def idleness(self, now: float) -> Floats:
        """Return the mean time (maps,) [s] since places were seen; unseen places count from 0 s on."""
        idle: Floats = now - np.maximum(self.seen, 0.0).mean(axis=(1, 2))
        return idle


@kernel
def mark(
    positions: Floats, maps: Ints, now: float, corner: float, sight: float, pitch: float, closed: bool, seen: Floats
) -> None:
    """Write `now` into the cells of `seen` (maps, G, G) whose middles are within `sight` of positions (R, 2)."""
    cells = seen.shape[1]
    for row in range(positions.shape[0]):
        x, y = (positions[row, 0] - corner) / pitch - 0.5, (positions[row, 1] - corner) / pitch - 0.5
        radius = sight / pitch
        for j in range(int(np.ceil(y - radius)), int(np.floor(y + radius)) + 1):
            half = np.sqrt(max(radius * radius - (j - y) * (j - y), 0.0))
            for i in range(int(np.ceil(x - half)), int(np.floor(x + half)) + 1):
                if closed:
                    seen[maps[row], j % cells, i % cells] = now
                elif 0 <= i < cells and 0 <= j < cells:
                    seen[maps[row], j, i] = now
