"""Garbage and cargo: which item lies where, who carries what, and what is done with it.

Each item goes: lying -> carried by a robot (to the recycling station, then its leftovers to the dump) -> done. It lies
again where its robot is lost. Rows of items that are absent or done are free for items that arrive later.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from selforg.compiler.decorators import inlined, lean_kernel
from selforg.space import nearest_image

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LYING, CARRIED, DONE, ABSENT = range(4)
NOTHING = -1


class Garbage:
    """Items of W worlds with M items and N robots each; rows are robots, R = W * N.

    Attributes:
        positions: (W, M, 2) float64 [m], where an item lies or was picked.
        stage: (W, M) int64, LYING, CARRIED, DONE or ABSENT.
        leftover: (W, M) int64, 1 where what lies has been recycled already.
        cargo: (R,) int64, the item a robot carries, or NOTHING.
        recycled: (R,) int64, 1 once the cargo has been recycled.
        done: (W,) int64, items dumped.
        arrived: (W,) int64, items that have come into the world.

    """

    def __init__(self, worlds: int, items: int, robots: int) -> None:
        self.robots = robots
        self.positions: Floats = np.zeros((worlds, items, 2))
        self.stage: Ints = np.zeros((worlds, items), dtype=np.int64)
        self.leftover: Ints = np.zeros((worlds, items), dtype=np.int64)
        self.cargo: Ints = np.full(worlds * robots, NOTHING, dtype=np.int64)
        self.recycled: Ints = np.zeros(worlds * robots, dtype=np.int64)
        self.done: Ints = np.zeros(worlds, dtype=np.int64)
        self.arrived: Ints = np.zeros(worlds, dtype=np.int64)

    def place(self, world: int, positions: Floats) -> None:
        """Lay out items of a world at `positions` (up to M, 2), in the first rows; nobody carries anything."""
        self.positions[world] = 0.0
        self.positions[world, : len(positions)] = positions
        self.stage[world] = ABSENT
        self.stage[world, : len(positions)] = LYING
        self.leftover[world] = 0
        rows = slice(world * self.robots, (world + 1) * self.robots)
        self.cargo[rows] = NOTHING
        self.recycled[rows] = 0
        self.done[world] = 0
        self.arrived[world] = len(positions)

    def arrive(self, world: int, position: Floats) -> bool:
        """Let an item come into a world at `position` (2,) [m]; False if all its rows are taken."""
        free = np.flatnonzero(self.stage[world] >= DONE)
        if not len(free):
            return False
        self.positions[world, free[0]] = position
        self.stage[world, free[0]] = LYING
        self.leftover[world, free[0]] = 0
        self.arrived[world] += 1
        return True

    def drop(self, row: int, position: Floats) -> bool:
        """Let what a robot carries lie at `position` (2,) [m], recycled or not; False if it carries nothing."""
        item, world = int(self.cargo[row]), row // self.robots
        if item == NOTHING:
            return False
        self.positions[world, item] = position
        self.stage[world, item] = LYING
        self.leftover[world, item] = self.recycled[row]
        self.cargo[row] = NOTHING
        self.recycled[row] = 0
        return True


@inlined
def distance(ax: float, ay: float, bx: float, by: float, extent: Floats) -> float:
    """Distance [m] of two points on the torus `extent` (2,)."""
    x, y = nearest_image(bx - ax, extent[0]), nearest_image(by - ay, extent[1])
    return float(np.sqrt(x * x + y * y))


@lean_kernel
def nearest_lying(x: float, y: float, positions: Floats, stage: Ints, extent: Floats) -> tuple[int, float]:
    """Return the nearest lying item of one world and its distance [m]; (NOTHING, inf) if none lies."""
    best, shortest = NOTHING, np.inf
    for item in range(positions.shape[0]):
        if stage[item] == LYING:
            d = distance(x, y, positions[item, 0], positions[item, 1], extent)
            if d < shortest:
                best, shortest = item, d
    return best, shortest


@lean_kernel
def handle_cargo(
    started: Ints, columns: Ints, robots: Floats, extent: Floats, pick_distance: float, nearest: Ints,
    positions: Floats, stage: Ints, leftover: Ints, cargo: Ints, recycled: Ints, done: Ints, picked: Ints,
) -> int:  # fmt: skip
    """Let the rows act that have just started to pick, recycle or dump, in the order of rows.

    started (R, B): `columns` (3,) of it are picking, recycling and dumping. robots (R, 2) and extent (2,) [m].
    pick_distance [m]: within which the nearest item is taken; nearest (R,): the item that was the nearest one lying
    when the robots looked, NOTHING where none was near. positions, stage, leftover, cargo, recycled, done: of
    `Garbage`, changed in place. picked (R, 2): filled with (row, item) of what was picked; their number is returned.
    """
    count = 0
    per_world = robots.shape[0] // positions.shape[0]
    for row in range(robots.shape[0]):
        world = row // per_world
        if started[row, columns[0]] and cargo[row] == NOTHING:
            x, y, item, near = robots[row, 0], robots[row, 1], nearest[row], np.inf
            if item != NOTHING and stage[world, item] == LYING:
                near = distance(x, y, positions[world, item, 0], positions[world, item, 1], extent)
            elif item != NOTHING:  # another robot has just taken it
                item, near = nearest_lying(x, y, positions[world], stage[world], extent)
            if item != NOTHING and near <= pick_distance:
                cargo[row] = item
                recycled[row] = leftover[world, item]
                stage[world, item] = CARRIED
                picked[count, 0], picked[count, 1] = row, item
                count += 1
        if started[row, columns[1]] and cargo[row] != NOTHING:
            recycled[row] = 1
        if started[row, columns[2]] and cargo[row] != NOTHING and recycled[row]:
            stage[world, cargo[row]] = DONE
            cargo[row] = NOTHING
            recycled[row] = 0
            done[world] += 1
    return count
