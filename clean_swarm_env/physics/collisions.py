"""Counts of collisions: how often robots are too close to each other, and how often they come too close.

A *sample* is a pair of robots closer than a collision distance at one count; an *event* is a pair that is closer now
and was not at the count before. The paper's collisions are samples; events do not depend on the sampling rate.
Shapes: W worlds, N robots a world, R = W * N rows (world w has the rows w*N .. (w+1)*N - 1), K distances.
"""

from typing import Annotated, Final, NamedTuple

import numpy as np

from clean_swarm_env.physics.cells import NOBODY, cell_at, cell_beside, cells_along, fill_cells
from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints, derived
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Packed, Written, opening
from selforg.declared import arrays_of
from selforg.space import nearest_image

UNLISTED: Final = -1  # number of listed pairs where there is no list
PAIRS_A_ROBOT: Final = 8  # room in the list; in a world with more, all pairs are looked at


class Counts(NamedTuple):
    """The counts, and what the search for close pairs needs."""

    samples: Annotated[Ints, "W K", KEPT]  # pairs closer than each distance, summed over the counts
    events: Annotated[Ints, "W K", KEPT]  # pairs that came closer than each distance
    in_contact: Annotated[Flags, "R", KEPT]  # another robot is closer than the first distance
    entered: Annotated[Ints, "R", KEPT]  # events of the first distance at the last count
    entered_in_tick: Annotated[Ints, "R", SCRATCH]  # the same, summed over a tick
    distances: Annotated[Floats, "K", READ]  # [m]
    squares: Annotated[Floats, "K", READ]  # of the distances [m^2]
    wider: Annotated[Floats, "R", READ]  # by how much the robot's radius exceeds that of the distances [m]
    furthest: float  # square of the longest distance of any pair [m^2]
    width: float  # of the torus [m]
    height: float  # [m]
    extent: Annotated[Floats, "2", READ]  # both, as `physics.cells` takes them
    before: Annotated[Floats, "R 2", KEPT]  # positions at the last count [m], undefined before the first
    counted: Annotated[Flags, "R", KEPT]  # the robot was there at the last count
    cells: Annotated[Ints, "lines columns", SCRATCH]  # scratch: see `cells`; empty where all pairs are looked at
    links: Annotated[Ints, "N", SCRATCH]  # scratch: see `cells`
    listed: Annotated[Ints, "W", derived(UNLISTED)]  # number of listed pairs, or UNLISTED
    pairs: Annotated[Ints, "W P 2", SCRATCH]  # rows of the pairs that can be close
    origins: Annotated[Floats, "L 2", SCRATCH]  # positions when the pairs were listed [m]


open_counts = opening(Counts)


class CollisionCounter:
    """Collision samples and events of W worlds of N robots, for K distances at once.

    The distances are those of robots that are alike. Robots that are `wider` (R,) [m] than these count at the same gap
    between bodies.

    samples: (W, K) int64, pairs closer than distance k, summed over all counts since the reset.
    events: (W, K) int64, pairs closer than distance k that were not closer at the count before, summed in the same way.
    in_contact: (R,) bool, of the last count: another robot is closer than the first distance.
    entered: (R,) int64, of the last count: events of the first distance in which the robot took part.
    entered_in_tick: (R,) int64, the same, summed over the counts of the last tick of the physics.
    All five are the same arrays all the time.
    packed: the record that compiled code takes.

    >>> counter = CollisionCounter(worlds=1, robots=2, width=11.0, height=11.0)
    >>> for x in (0.3, 0.2, 0.2):
    ...     count_world(0, np.array([[x, 5.0], [10.75, 5.0]]), np.ones(2, np.bool_), counter.packed.handle)
    >>> counter.samples.tolist(), counter.events.tolist()
    ([[2, 3]], [[1, 1]])
    """

    def __init__(
        self,
        worlds: int,
        robots: int,
        width: float,
        height: float,
        distances: tuple[float, ...] = (0.5, 1.0),
        wider: float | Floats = 0.0,
    ) -> None:
        rows, extent = worlds * robots, np.array([width, height], dtype=np.float64)
        self._robots = robots
        # Cells are at least two reaches wide. So pairs up to two reaches apart are listed, and the list is valid until
        # a robot has moved by half a reach.
        wider = np.full(rows, wider, dtype=np.float64)
        furthest = max(distances) + 2.0 * float(wider.max(initial=0.0))
        shape = cells_along(robots, 2.0 * furthest, extent)
        room = robots if shape[0] else 0
        self.packed: Packed[Counts] = Packed(
            Counts(
                distances=np.array(distances, dtype=np.float64),
                squares=np.square(np.array(distances, dtype=np.float64)),
                wider=wider,
                furthest=furthest * furthest,
                width=float(width),
                height=float(height),
                extent=extent,
                **arrays_of(
                    Counts,
                    W=worlds,
                    R=rows,
                    K=len(distances),
                    N=room,
                    P=PAIRS_A_ROBOT * room,
                    L=worlds * room,
                    lines=shape[0],
                    columns=shape[1],
                ),
            )
        )
        self.packed.record.listed[:] = UNLISTED
        self.samples, self.events, self.in_contact, self.entered, self.entered_in_tick = self.packed.record[:5]

    def reset(self, world: int) -> None:
        """Set the counts of a world to zero; a pair that is close at its next count is an event again."""
        rows = slice(world * self._robots, (world + 1) * self._robots)
        self.samples[world] = 0
        self.events[world] = 0
        self.in_contact[rows] = False
        self.entered[rows] = 0
        self.packed.record.counted[rows] = False
        self.packed.record.listed[world] = UNLISTED


@inlined
def square_distance(positions: Floats, first: int, second: int, width: float, height: float) -> float:
    """Return the square of the shortest way between two rows of positions (R, 2) on the torus [m^2]."""
    dx = nearest_image(positions[first, 0] - positions[second, 0], width)
    dy = nearest_image(positions[first, 1] - positions[second, 1], height)
    return dx * dx + dy * dy


@inlined
def list_holds(world: int, positions: Floats, present: Flags, c: Counts) -> bool:
    """Return whether the list of a world has every pair that can be close now, and no robot came or went."""
    if c.listed[world] == UNLISTED:
        return False
    robots = positions.shape[0] // c.listed.shape[0]
    for row in range(world * robots, (world + 1) * robots):
        dx = nearest_image(positions[row, 0] - c.origins[row, 0], c.width)
        dy = nearest_image(positions[row, 1] - c.origins[row, 1], c.height)
        if present[row] != c.counted[row] or dx * dx + dy * dy > 0.2499 * c.furthest:
            return False
    return True


@lean_kernel
def list_pairs(world: int, positions: Floats, present: Flags, counts: Written[Counts]) -> None:
    """List the pairs of a world that are closer than twice the furthest distance, and leave its robots in the cells."""
    c = open_counts(counts)
    robots = positions.shape[0] // c.listed.shape[0]
    lines, columns = c.cells.shape
    first, count = world * robots, 0
    fill_cells(positions, first, present[first : first + robots], c.extent, c.cells, c.links)
    for row in range(first, first + robots):
        c.origins[row, 0], c.origins[row, 1] = positions[row, 0], positions[row, 1]
        if not present[row]:
            continue
        line, column = cell_at(positions[row, 1], lines, c.extent[1]), cell_at(positions[row, 0], columns, c.extent[0])
        for walk in range(9):
            point = cell_beside(line, column, walk, c.cells)
            while point != NOBODY and first + point < row:  # numbers in a cell rise
                if square_distance(positions, row, first + point, c.width, c.height) < 4.0 * c.furthest:
                    if count < c.pairs.shape[1]:
                        c.pairs[world, count, 0], c.pairs[world, count, 1] = row, first + point
                    count += 1
                point = c.links[point]
    c.listed[world] = count if count <= c.pairs.shape[1] else UNLISTED


@inlined
def count_pair(world: int, row: int, other: int, positions: Floats, c: Counts) -> None:
    """Count one pair of robots that are present. The counts are sums, so the order of pairs does not matter."""
    now = square_distance(positions, row, other, c.width, c.height)
    if now >= c.furthest:
        return
    was = square_distance(c.before, row, other, c.width, c.height) if c.counted[row] and c.counted[other] else np.inf
    wider = c.wider[row] + c.wider[other]
    for k in range(c.squares.shape[0]):
        square = c.squares[k]
        if wider != 0.0:
            square = max(c.distances[k] + wider, 0.0) ** 2
        c.samples[world, k] += now < square
        c.events[world, k] += now < square <= was
        if k == 0 and now < square:
            c.in_contact[row] = c.in_contact[other] = True
            c.entered[row] += was >= square
            c.entered[other] += was >= square


@lean_kernel
def count_world(world: int, positions: Floats, present: Flags, counts: Written[Counts]) -> None:
    """Count the robots `present` (R,) of one world, whose positions (R, 2) [m] are in [0, width) x [0, height)."""
    c = open_counts(counts)
    robots = positions.shape[0] // c.samples.shape[0]
    first, end = world * robots, (world + 1) * robots
    if c.cells.shape[0] > 0 and not list_holds(world, positions, present, c):
        list_pairs(world, positions, present, counts)
    for row in range(first, end):
        c.in_contact[row] = False
        c.entered[row] = 0
    for index in range(c.listed[world]):
        count_pair(world, c.pairs[world, index, 0], c.pairs[world, index, 1], positions, c)
    if c.listed[world] == UNLISTED:
        for row in range(first, end):
            for other in range(first, row):
                if present[row] and present[other]:
                    count_pair(world, row, other, positions, c)
    # Element by element: assigning whole slices costs more than counting the pairs of a small world.
    for row in range(first, end):
        c.before[row, 0] = positions[row, 0]
        c.before[row, 1] = positions[row, 1]
        c.counted[row] = present[row]
        c.entered_in_tick[row] += c.entered[row]
