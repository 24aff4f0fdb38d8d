"""Counting collisions: how often robots are too close to each other, and how often they come too close.

A *sample* is a pair of robots closer than a collision distance at one count; an *event* is a pair that is closer now
and was not at the count before. The paper's collisions are samples; events do not depend on the sampling rate.
Shapes: W worlds, N robots a world, R = W * N rows (world w has the rows w*N .. (w+1)*N - 1), K distances.
"""

from collections.abc import Callable
from math import ceil, isfinite, sqrt
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.physics.motion import shorter_way
from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import inlined, lean_kernel

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Flags: TypeAlias = NDArray[np.bool_]

ALL_PAIRS_LIMIT: Final = 50  # robots in a world up to which looking at all pairs is cheaper than keeping a list
NOBODY: Final = -1  # end of a cell's list
UNLISTED: Final = -1  # number of listed pairs where there is no list
PAIRS_A_ROBOT: Final = 8  # room in the list; where it does not do, every count walks the cells

# before (R, 2), counted (R,), squares (K,), samples (W, K), events (W, K), in contact (R,), entered (R,), near (N,),
# following (N,), cells (lines, columns), listed (W,), pairs (W, P, 2), origins (R, 2), width, height, furthest square
Counts: TypeAlias = tuple[
    Floats, Flags, Floats, Ints, Ints, Flags, Ints, Ints, Ints, Ints, Ints, Ints, Floats, float, float, float
]  # fmt: skip
COUNT_TABLES = Layout(
    "f2", "b1", "f1", "i2", "i2", "b1", "i1", "i1", "i1", "i2", "i1", "i3", "f2", "number", "number", "number"
)  # fmt: skip
counts_of: Callable[[Bundle], Counts] = COUNT_TABLES.unbundle


class CollisionCounter:
    """Collision samples and events of W worlds of N robots, for K distances at once.

    samples: (W, K) int64, pairs closer than distance k, summed over all counts since the reset.
    events: (W, K) int64, pairs closer than distance k that were not closer at the count before, summed likewise.
    in_contact: (R,) bool, of the last count: somebody closer than the first distance.
    entered: (R,) int64, of the last count: events of the first distance in which the robot took part.
    All four are the same arrays all the time.
    tables: what `count_world` takes after the robots that are present.
    bundle: the same as one argument.

    Raises ValueError for sizes below 1, a torus without extent and distances that are not positive.

    >>> counter = CollisionCounter(worlds=1, robots=2, width=11.0, height=11.0)
    >>> for x in (0.3, 0.2, 0.2):
    ...     counter.count(np.array([[x, 5.0], [10.75, 5.0]]))
    >>> counter.samples.tolist(), counter.events.tolist()
    ([[2, 3]], [[1, 1]])
    """

    def __init__(
        self, worlds: int, robots: int, width: float, height: float, distances: tuple[float, ...] = (0.5, 1.0)
    ) -> None:
        for name, number in (("worlds", worlds), ("robots", robots), ("distances", len(distances))):
            if number < 1:
                raise ValueError(f"{name}: expected at least 1, got {number}")
        lengths = [("width", width), ("height", height)]
        lengths += [(f"distances[{k}]", distance) for k, distance in enumerate(distances)]
        for name, length in lengths:
            if not (length > 0.0 and isfinite(length)):
                raise ValueError(f"{name}: expected a positive number of metres, got {length}")
        rows, reach = worlds * robots, max(distances)
        self.distances = tuple(float(distance) for distance in distances)
        self.samples = np.zeros((worlds, len(distances)), np.int64)
        self.events = np.zeros((worlds, len(distances)), np.int64)
        self.in_contact = np.zeros(rows, np.bool_)
        self.entered = np.zeros(rows, np.int64)
        self._width, self._height = float(width), float(height)
        self._squares = np.square(self.distances)  # (K,) [m^2]
        self._furthest = float(self._squares.max())  # [m^2]
        self._robots = robots
        self._everybody = np.ones(rows, np.bool_)
        self._before = np.zeros((rows, 2))  # [m] positions at the last count, of no meaning before the first
        self._counted = np.zeros(rows, np.bool_)  # was this robot there at the last count?
        # Cells at least two reaches wide: pairs up to there are listed, and the list holds until somebody has moved by
        # half a reach.
        side = ceil(sqrt(robots))
        self._columns, self._lines = min(int(width // (2.0 * reach)), side), min(int(height // (2.0 * reach)), side)
        if robots <= ALL_PAIRS_LIMIT or self._columns < 3 or self._lines < 3:
            self._columns = self._lines = robots = 0
        self._listed = np.full(worlds, UNLISTED)  # (W,) pairs listed
        self.tables = (
            self._before, self._counted, self._squares, self.samples, self.events, self.in_contact, self.entered,
            np.empty(robots, np.int64), np.empty(robots, np.int64), np.empty((self._lines, self._columns), np.int64),
            self._listed, np.empty((worlds, PAIRS_A_ROBOT * robots, 2), np.int64), np.empty((worlds * robots, 2)),
            self._width, self._height, self._furthest,
        )  # fmt: skip
        self.bundle: Bundle = COUNT_TABLES.bundle(*self.tables)

    def reset(self, world: int) -> None:
        """Forget what this world has counted; a pair that is close at its next count is an event again."""
        rows = slice(world * self._robots, (world + 1) * self._robots)
        self.samples[world] = 0
        self.events[world] = 0
        self.in_contact[rows] = False
        self.entered[rows] = 0
        self._counted[rows] = False
        self._listed[world] = UNLISTED

    def count(self, positions: NDArray[np.float64], present: NDArray[np.bool_] | None = None) -> None:
        """Count all worlds once: the robots `present` (R,) or all; positions (R, 2) [m] in [0, width) x [0, height)."""
        count_pairs(positions, self._everybody if present is None else present, *self.tables)


@inlined
def square_distance(positions: NDArray[np.float64], first: int, second: int, width: float, height: float) -> float:
    """Square of the shorter way between two rows of positions (R, 2) on the torus [m^2]."""
    dx = shorter_way(positions[first, 0] - positions[second, 0], width)
    dy = shorter_way(positions[first, 1] - positions[second, 1], height)
    return dx * dx + dy * dy


@lean_kernel
def enter_cell(
    row: int,
    positions: NDArray[np.float64],
    cells: NDArray[np.int64],
    following: NDArray[np.int64],
    near: NDArray[np.int64],
    width: float,
    height: float,
) -> int:
    """Put a row into its cell, after listing all rows that are in this or an adjacent cell already.

    positions (N, 2) [m] of one world; cells (lines, columns): the last row in each cell; following (N,): the row
    before it in the same cell; near (N,): gets the rows found, whose number is returned.
    """
    lines, columns = cells.shape
    line = min(int(positions[row, 1] * (lines / height)), lines - 1)
    column = min(int(positions[row, 0] * (columns / width)), columns - 1)
    found = 0
    for up in range(line - 1, line + 2):
        beside_line = up + lines if up < 0 else (up - lines if up >= lines else up)
        for right in range(column - 1, column + 2):
            beside = right + columns if right < 0 else (right - columns if right >= columns else right)
            other = cells[beside_line, beside]
            while other != NOBODY:
                near[found] = other
                found += 1
                other = following[other]
    following[row] = cells[line, column]
    cells[line, column] = row
    return found


@inlined
def list_holds(
    world: int, positions: Floats, present: Flags, counted: Flags, listed: Ints, origins: Floats, width: float,
    height: float, furthest: float,
) -> bool:  # fmt: skip
    """Tell whether every pair that can be close by now is in the list of a world, and nobody came or went."""
    if listed[world] == UNLISTED:
        return False
    robots = positions.shape[0] // listed.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        dx = shorter_way(positions[row, 0] - origins[row, 0], width)
        dy = shorter_way(positions[row, 1] - origins[row, 1], height)
        if present[row] != counted[row] or dx * dx + dy * dy > 0.2499 * furthest:
            return False
    return True


@lean_kernel
def list_pairs(
    world: int, positions: Floats, present: Flags, near: Ints, following: Ints, cells: Ints, listed: Ints, pairs: Ints,
    origins: Floats, width: float, height: float, furthest: float,
) -> None:  # fmt: skip
    """List the pairs of a world that are closer than twice the furthest distance; see CollisionCounter."""
    robots = positions.shape[0] // listed.shape[0]
    first, count = world * robots, 0
    cells[:] = NOBODY
    for row in range(first, first + robots):
        origins[row, 0], origins[row, 1] = positions[row, 0], positions[row, 1]
        if not present[row]:
            continue
        found = enter_cell(row - first, positions[first : first + robots], cells, following, near, width, height)
        for index in range(found):
            other = first + near[index]
            if square_distance(positions, row, other, width, height) >= 4.0 * furthest:
                continue
            if count < pairs.shape[1]:
                pairs[world, count, 0], pairs[world, count, 1] = row, other
            count += 1
    listed[world] = count if count <= pairs.shape[1] else UNLISTED


@inlined
def count_pair(
    world: int, row: int, other: int, positions: Floats, before: Floats, counted: Flags, squares: Floats, samples: Ints,
    events: Ints, in_contact: Flags, entered: Ints, width: float, height: float, furthest: float,
) -> None:  # fmt: skip
    """Count one pair of robots that are present. Only sums: no order matters."""
    now = square_distance(positions, row, other, width, height)
    if now >= furthest:
        return
    was = square_distance(before, row, other, width, height) if counted[row] and counted[other] else np.inf
    for k in range(squares.shape[0]):
        samples[world, k] += now < squares[k]
        events[world, k] += now < squares[k] <= was
    if now < squares[0]:
        in_contact[row] = in_contact[other] = True
        entered[row] += was >= squares[0]
        entered[other] += was >= squares[0]


@lean_kernel
def count_world(
    world: int, positions: Floats, present: Flags, before: Floats, counted: Flags, squares: Floats, samples: Ints,
    events: Ints, in_contact: Flags, entered: Ints, near: Ints, following: Ints, cells: Ints, listed: Ints,
    pairs: Ints, origins: Floats, width: float, height: float, furthest: float,
) -> None:  # fmt: skip
    """Count one world and remember its positions; see CollisionCounter.

    near, following (N,) and cells (lines, columns) are scratch; of no length where all pairs are looked at. listed
    (W,), pairs (W, P, 2) and origins (R, 2): the pairs that can be close, and where robots were when they were listed.
    """
    robots = positions.shape[0] // samples.shape[0]
    in_cells = near.shape[0] > 0
    first, end = world * robots, (world + 1) * robots
    if in_cells and not list_holds(world, positions, present, counted, listed, origins, width, height, furthest):
        list_pairs(
            world, positions, present, near, following, cells, listed, pairs, origins, width, height, furthest
        )  # fmt: skip
    walking = in_cells and listed[world] == UNLISTED
    if walking:
        cells[:] = NOBODY
    for row in range(first, end):
        in_contact[row] = False
        entered[row] = 0
    for index in range(listed[world]):
        count_pair(
            world, pairs[world, index, 0], pairs[world, index, 1], positions, before, counted, squares, samples, events,
            in_contact, entered, width, height, furthest,
        )  # fmt: skip
    if walking:
        for row in range(first, end):
            if not present[row]:
                continue
            found = enter_cell(row - first, positions[first:end], cells, following, near, width, height)
            for index in range(found):
                count_pair(
                    world, row, first + near[index], positions, before, counted, squares, samples, events, in_contact,
                    entered, width, height, furthest,
                )  # fmt: skip
    elif not in_cells:
        for row in range(first, end):
            for other in range(first, row):
                if present[row] and present[other]:
                    count_pair(
                        world, row, other, positions, before, counted, squares, samples, events, in_contact, entered,
                        width, height, furthest,
                    )  # fmt: skip
    # One by one: assigning whole slices costs more than the pairs of a small world.
    for row in range(first, end):
        before[row, 0] = positions[row, 0]
        before[row, 1] = positions[row, 1]
        counted[row] = present[row]


@lean_kernel
def count_pairs(
    positions: Floats, present: Flags, before: Floats, counted: Flags, squares: Floats, samples: Ints, events: Ints,
    in_contact: Flags, entered: Ints, near: Ints, following: Ints, cells: Ints, listed: Ints, pairs: Ints,
    origins: Floats, width: float, height: float, furthest: float,
) -> None:  # fmt: skip
    """Count every world once; see `count_world`."""
    for world in range(samples.shape[0]):
        count_world(
            world, positions, present, before, counted, squares, samples, events, in_contact, entered, near, following,
            cells, listed, pairs, origins, width, height, furthest,
        )  # fmt: skip
