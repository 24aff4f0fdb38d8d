"""The view angle: what lies ahead of a row, to either side of its heading."""

import numpy as np

from selforg.compiler.decorators import lean_kernel, part
from selforg.compiler.records import Words
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, Sight, open_poses, open_sight


@lean_kernel
def keep_ahead(row: int, found: int, angle_xy: float, angle_yz: float, sight: Words[Sight], poses: Words[Poses]) -> int:
    """Keep of the first `found` pairs those within the view angles [rad] of the own heading; return how many."""
    own, pairs = open_poses(poses).own, open_sight(sight).pairs
    x, y, z = own[row, 0, c.POSE_HEADING], own[row, 0, c.POSE_HEADING + 1], own[row, 0, c.POSE_HEADING + 2]
    kept = 0
    for index in range(found):
        xy = angle_between(x, y, pairs[index, c.PAIR_DX], pairs[index, c.PAIR_DY])
        yz = angle_between(y, z, pairs[index, c.PAIR_DY], pairs[index, c.PAIR_DZ])
        if xy <= angle_xy and yz <= angle_yz:
            for column in range(c.PAIR_COLUMNS):
                pairs[kept, column] = pairs[index, column]
            kept += 1
    return kept


@part
def angle_between(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the angle [rad] in [0, pi] between two plane vectors; a zero vector points along the first axis."""
    difference = float(abs(np.arctan2(ay, ax) - np.arctan2(by, bx)))
    return min(difference, 2.0 * np.pi - difference)
