"""Cells of the own poses: only teams of more than CROWD robots need them, smaller ones are looked through."""

from collections.abc import Callable

from selforg.arrays import Floats, Ints, Links
from selforg.compiler.bundles import Bundle, Layout
from selforg.compiler.decorators import lean_kernel
from selforg.gradients.store.columns import DIFFUSION, GOAL, POSES, TEAM, X, Y, Z
from selforg.gradients.store.grid import bucket_of, cell_of

CROWD = 32

# own (N, K, POSE_COLUMNS), rows (N, ROW_COLUMNS), first member of each team (T + 1,), members (N,),
# largest reach in each team (T,) [m], extent (3,) [m], cells (1, GRID_COLUMNS), buckets, next in bucket and cell (N, 2)
Poses = tuple[Floats, Ints, Ints, Ints, Floats, Floats, Floats, Links, Links]
POSE_TABLES = Layout("f3", "i2", "i1", "i1", "f1", "f1", "f2", "l1", "l2")
poses_of: Callable[[Bundle], Poses] = POSE_TABLES.unbundle


@lean_kernel
def index_poses(poses: Bundle) -> None:
    """Note the largest reach of every team and put the rows of crowds into cells."""
    own, rows, first, members, reach, _, grid, buckets, links = poses_of(poses)
    crowded = False
    for team in range(len(reach)):
        reach[team] = 0.0
        crowded |= first[team + 1] - first[team] > CROWD
        for index in range(first[team], first[team + 1]):
            row = members[index]
            if rows[row, POSES] > 0:
                reach[team] = max(reach[team], own[row, 0, DIFFUSION] + own[row, 0, GOAL])
    if not crowded:
        return
    buckets[:] = -1
    only = min(0, len(grid))  # not a constant: Numba would compile all it is handed to once more
    for row in range(len(rows) - 1, -1, -1):  # backwards: a bucket then lists its rows in their order
        team = int(rows[row, TEAM])
        if rows[row, POSES] == 0 or first[team + 1] - first[team] <= CROWD:
            continue
        cell = cell_of(own[row, 0, X], own[row, 0, Y], own[row, 0, Z], grid, only)
        bucket = bucket_of(team, cell, buckets)
        links[row, 0] = buckets[bucket]
        links[row, 1] = cell
        buckets[bucket] = row
