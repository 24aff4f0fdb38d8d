"""Cells of the own poses, for teams of more than CROWD robots; in smaller teams all poses are looked at."""

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Words
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.grid import CELL_COLUMNS, axis_cells, bucket_of, cell_of
from selforg.space import Space

CROWD = 32  # robots of a team


def make_pose_cells(space: Space, reach: float, sizes: Ints) -> Floats:
    """Return the grid (1, CELL_COLUMNS) for poses of one `reach` [m], of teams of some `sizes` (T,).

    A cell is wide enough for about one robot, because looking into empty cells costs more than looking at robots that
    are too far away.
    """
    width = max(reach, 0.1) if np.isfinite(reach) else 1.0
    width = max(width, float(np.prod(space.extent) / sizes.max()) ** (1.0 / space.dim))
    cells = np.zeros((1, CELL_COLUMNS))
    for axis, side in enumerate(space.padded_extent):
        cells[0, 2 * axis : 2 * axis + 2] = axis_cells(side, width, 1024.0 if side <= 0.0 else np.inf)
    return cells


@lean_kernel
def index_poses(poses: Words[Poses]) -> None:
    """Write the largest reach of every team, and put the rows of large teams into cells."""
    p = open_poses(poses)
    crowded = False
    for team in range(len(p.reach)):
        p.reach[team] = 0.0
        crowded |= p.first[team + 1] - p.first[team] > CROWD
        for index in range(p.first[team], p.first[team + 1]):
            row = p.members[index]
            if p.rows[row, c.ROW_POSES] > 0:
                p.reach[team] = max(p.reach[team], p.own[row, 0, c.DIFFUSION] + p.own[row, 0, c.GOAL_RADIUS])
    if not crowded:
        return
    p.buckets[:] = -1
    for row in range(len(p.rows) - 1, -1, -1):  # backwards: a bucket then lists its rows in their order
        team = int(p.rows[row, c.ROW_TEAM])
        if p.rows[row, c.ROW_POSES] == 0 or p.first[team + 1] - p.first[team] <= CROWD:
            continue
        cell = cell_of(p.own[row, 0, c.X], p.own[row, 0, c.Y], p.own[row, 0, c.Z], p.cells, 0)
        bucket = bucket_of(team, cell, p.buckets)
        p.links[row, 0] = p.buckets[bucket]
        p.links[row, 1] = cell
        p.buckets[bucket] = row
