"""Garbage and cargo: which item lies where, who carries what, and what is done with it.

Each item goes: lying -> carried by a robot (to the recycling station, then its leftovers to the dump) -> done.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from selforg.compiled import kernel
from selforg.space import nearest_image

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LYING, CARRIED, DONE = range(3)
NOTHING = -1


class Garbage:
    """Items of W worlds with M items and N robots each; rows are robots, R = W * N.

    Attributes:
        positions: (W, M, 2) float64 [m], where an item lies or was picked.
        stage: (W, M) int64, LYING, CARRIED or DONE.
        cargo: (R,) int64, the item a robot carries, or NOTHING.
        recycled: (R,) int64, 1 once the cargo has been recycled.
        done: (W,) int64, items dumped.

    """

    def __init__(self, worlds: int, items: int, robots: int) -> None:
        self.robots = robots
        self.positions: Floats = np.zeros((worlds, items, 2))
        self.stage: Ints = np.zeros((worlds, items), dtype=np.int64)
        self.cargo: Ints = np.full(worlds * robots, NOTHING, dtype=np.int64)
        self.recycled: Ints = np.zeros(worlds * robots, dtype=np.int64)
        self.done: Ints = np.zeros(worlds, dtype=np.int64)

    def place(self, world: int, positions: Floats) -> None:
        """Lay out the items of a world at `positions` (M, 2); nobody carries anything."""
        self.positions[world] = positions
        self.stage[world] = LYING
        rows = slice(world * self.robots, (world + 1) * self.robots)
        self.cargo[rows] = NOTHING
        self.recycled[rows] = 0
        self.done[world] = 0


@kernel
def distance(ax: float, ay: float, bx: float, by: float, extent: Floats) -> float:
    """Distance [m] of two points on the torus `extent` (2,)."""
    x, y = nearest_image(bx - ax, extent[0]), nearest_image(by - ay, extent[1])
    return float(np.sqrt(x * x + y * y))


@kernel
def nearest_lying(x: float, y: float, positions: Floats, stage: Ints, extent: Floats) -> tuple[int, float]:
    """Return the nearest lying item of one world and its distance [m]; (NOTHING, inf) if none lies."""
    best, shortest = NOTHING, np.inf
    for item in range(positions.shape[0]):
        if stage[item] == LYING:
            d = distance(x, y, positions[item, 0], positions[item, 1], extent)
            if d < shortest:
                best, shortest = item, d
    return best, shortest


@kernel
def handle_cargo(
    started: Ints, columns: Ints, robots: Floats, extent: Floats, pick_distance: float,
    positions: Floats, stage: Ints, cargo: Ints, recycled: Ints, done: Ints, picked: Ints,
) -> int:  # fmt: skip
    """Let the rows act that have just started to pick, recycle or dump, in the order of rows.

    started (R, B): `columns` (3,) of it are picking, recycling and dumping. robots (R, 2) and extent (2,) [m].
    pick_distance [m]: within which the nearest item is taken. positions, stage, cargo, recycled, done: of `Garbage`,
    changed in place. picked (R, 2): filled with (row, item) of what was picked; their number is returned.
    """
    count = 0
    per_world = robots.shape[0] // positions.shape[0]
    for row in range(robots.shape[0]):
        world = row // per_world
        if started[row, columns[0]] and cargo[row] == NOTHING:
            item, near = nearest_lying(robots[row, 0], robots[row, 1], positions[world], stage[world], extent)
            if item != NOTHING and near <= pick_distance:
                cargo[row] = item
                recycled[row] = 0
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
