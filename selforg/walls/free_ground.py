"""The ground on which discs of a radius have room among walls, and can drive to each other's places.

A raster of small squares says where a disc has room; squares that touch make up a region. The largest region is the
free ground. A door must be wider than the disc by a square.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.walls.segments import distances_to, to_line

SQUARES: Final = 4
"""Squares of the raster along the radius of a disc, where MOST_SQUARES allow."""
MOST_SQUARES: Final = 1_000_000
NO_ROOM, UNVISITED = -1, -2
"""In place of the number of a region: a disc has no room here; not looked at yet."""


@dataclass(frozen=True)
class FreeGround:
    """Where discs of `radius` [m] have room on the rectangle from `low` to `high` (2,) [m].

    Attributes:
        segments: (K, 4) walls [m], images included.
        regions: (lines, columns) number of the region of each square, NO_ROOM where a disc has none.
        sizes: squares of each region.

    """

    segments: Floats
    low: Floats
    high: Floats
    radius: float
    regions: Ints
    sizes: Ints

    @classmethod
    def among(
        cls, segments: Floats, solids: Sequence[Floats], low: Floats, high: Floats, radius: float, closed: bool
    ) -> "FreeGround":
        """Return the free ground among `segments` (K, 4) and outside of polygons (C, 2); `closed`: on a torus."""
        size = high - low
        pitch = max(radius / SQUARES, float(np.sqrt(size.prod() / MOST_SQUARES)))
        columns, lines = (max(int(np.ceil(side / pitch)), 1) for side in size)
        regions = np.full((lines, columns), UNVISITED)
        mark_walls(np.ascontiguousarray(segments), radius, low, size, regions)
        xs, ys = (low[k] + (np.arange(n) + 0.5) * size[k] / n for k, n in enumerate((columns, lines)))
        for corners in solids:
            regions[inside(xs, ys, corners)] = NO_ROOM
        found = number_regions(regions, closed, np.zeros(lines * columns, np.int64))
        return cls(segments, low, high, radius, regions, np.bincount(regions[regions >= 0], minlength=found))

    @property
    def main(self) -> int:
        """Number of the largest region."""
        return int(self.sizes.argmax())

    @property
    def area(self) -> float:
        """Area on which the middle of a disc may be [m2]."""
        return float(self.sizes.max(initial=0) * (self.high - self.low).prod() / self.regions.size)

    def closed_room(self) -> Floats | None:
        """Return a place (2,) [m] in a region without a door that is larger than a disc, None if there is none."""
        square = (self.high - self.low).prod() / self.regions.size
        for region in np.argsort(-self.sizes, kind="stable")[1:2]:
            if self.sizes[region] * square >= np.pi * self.radius**2:
                squares = np.argwhere(self.regions == region)
                line, column = squares[len(squares) // 2]
                return self._middle(int(line), int(column))
        return None

    def has(self, points: Floats) -> Flags:
        """Return for each of `points` (K, 2) [m] whether a disc has room there, and can drive to the free ground."""
        lines, columns = self.regions.shape
        shares = (points - self.low) / (self.high - self.low)
        column, line = (np.floor(shares * (columns, lines)).astype(np.int64)).T
        free: Flags = np.asarray(((shares >= 0.0) & (shares <= 1.0)).all(axis=1))
        column, line = np.clip(column, 0, columns - 1), np.clip(line, 0, lines - 1)
        for k in np.flatnonzero(free):
            around = self.regions[max(line[k] - 1, 0) : line[k] + 2, max(column[k] - 1, 0) : column[k] + 2]
            free[k] = self.clearance(points[k]) >= self.radius and (around == self.main).any()
        return free

    def clearance(self, point: Floats) -> float:
        """Return the distance [m] of a point (2,) from the nearest wall, infinity without walls."""
        return float(distances_to(self.segments, point).min(initial=np.inf))

    def _middle(self, line: int, column: int) -> Floats:
        lines, columns = self.regions.shape
        return self.low + (np.array([column, line]) + 0.5) * (self.high - self.low) / (columns, lines)


def inside(xs: Floats, ys: Floats, corners: Floats) -> Flags:
    """Return which places at rising `xs` (columns,) and `ys` (lines,) are inside of a polygon (C, 2): lines x columns.

    A place is inside if an odd number of edges lies to the right of it. In each line every edge is looked at once.
    """
    begins = np.zeros((len(ys), len(xs) + 1), np.bool_)  # whether an odd number lies between a place and the one before
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        lines = np.flatnonzero((ay > ys) != (by > ys))
        beside = (ys[lines] - ay) * (bx - ax) / (by - ay) + ax
        begins[lines, np.searchsorted(xs, beside)] ^= True
    return np.logical_xor.accumulate(begins[:, :0:-1], axis=1)[:, ::-1]


@lean_kernel
def mark_walls(segments: Floats, radius: float, low: Floats, size: Floats, regions: Ints) -> None:
    """Write NO_ROOM where the middle of a square is nearer to a segment (K, 4) than `radius` [m]."""
    lines, columns = regions.shape
    across, up = size[0] / columns, size[1] / lines
    for k in range(segments.shape[0]):
        ax, ay = segments[k, 0] - low[0], segments[k, 1] - low[1]
        wx, wy = segments[k, 2] - segments[k, 0], segments[k, 3] - segments[k, 1]
        first = max(int((min(ax, ax + wx) - radius) / across), 0)
        last = min(int((max(ax, ax + wx) + radius) / across) + 1, columns)
        lowest = max(int((min(ay, ay + wy) - radius) / up), 0)
        highest = min(int((max(ay, ay + wy) + radius) / up) + 1, lines)
        for line in range(lowest, highest):
            for column in range(first, last):
                dx, dy = to_line((column + 0.5) * across, (line + 0.5) * up, ax, ay, wx, wy)
                if dx * dx + dy * dy < radius * radius:
                    regions[line, column] = NO_ROOM


@inlined
def neighbour(line: int, column: int, walk: int, lines: int, columns: int, closed: bool) -> tuple[int, int]:
    """Return one of the nine squares about a square, itself included, `walk` 0 to 8; -1, -1 beyond an open edge."""
    i, j = line + walk // 3 - 1, column + walk % 3 - 1
    if closed:
        return i % lines, j % columns
    return (i, j) if 0 <= i < lines and 0 <= j < columns else (-1, -1)


@lean_kernel
def number_regions(regions: Ints, closed: bool, stack: Ints) -> int:
    """Give the squares that are UNVISITED the numbers of their regions, by eight neighbours; return how many there are.

    closed: whether opposite sides are one. stack: room for all squares.
    """
    lines, columns = regions.shape
    found = 0
    for square in range(lines * columns):
        if regions[square // columns, square % columns] != UNVISITED:
            continue
        regions[square // columns, square % columns] = found
        stack[0], count = square, 1
        while count > 0:
            count -= 1
            line, column = stack[count] // columns, stack[count] % columns
            for walk in range(9):
                i, j = neighbour(line, column, walk, lines, columns, closed)
                if i >= 0 and regions[i, j] == UNVISITED:
                    regions[i, j] = found
                    stack[count] = i * columns + j
                    count += 1
        found += 1
    return found
