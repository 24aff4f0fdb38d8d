"""Delivery of poses: which poses of the others a row has received, when messages have a range and get lost.

Own poses keep a short history. The pose that a row has received last from another one is an age in that history, so no
pose is copied: the table of rows has a column of ages for each member of the team, and a row that looks at poses begins
with that age.
"""

from collections.abc import Sequence

import numpy as np

from selforg.arrays import Floats
from selforg.compiler.decorators import kernel
from selforg.compiler.records import Words
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.space import nearest_image


class Hearing:
    """Delivers poses among the rows of `poses`; call `listen` after each update of the poses.

    Attributes:
        reaches: (T,) farthest receiver in each team [m]; the owner may change it.
        losses: (T,) probability that a receiver misses a pose, in each team; the owner may change it.
        generators: one for each row, for the losses of what it spreads; the owner may change it.

    Raises:
        ValueError: poses that were not made with `hearing`.

    """

    def __init__(
        self, poses: OwnPoses, reaches: Floats, losses: Floats, generators: Sequence[np.random.Generator]
    ) -> None:
        if poses.row_table.shape[1] == c.ROW_HEARD:
            raise ValueError("Hearing: the poses must be made with hearing=True")
        self.poses = poses
        self.reaches, self.losses, self.generators = reaches, losses, generators
        self._draws: Floats = np.zeros((poses.rows, poses.row_table.shape[1] - c.ROW_HEARD))

    def listen(self) -> None:
        """Deliver the newest pose of each row to the other rows in range, unless it gets lost."""
        lossy = (self.losses > 0.0) & (self.losses < 1.0)
        if lossy.any():
            for row in np.flatnonzero(lossy[self.poses.teams] & self.poses.known).tolist():
                self._draws[row] = self.generators[row].random(self._draws.shape[1])
        hear(self.poses.packed.words, self.reaches, self.losses, self._draws)


@kernel
def hear(poses: Words[Poses], reaches: Floats, losses: Floats, draws: Floats) -> None:
    """Note for each pair of a team the age of the last pose received, -1 for none that is still remembered.

    reaches (T,) [m], losses (T,), draws (N, most members) uniform in [0, 1) of the row that spreads.
    """
    p = open_poses(poses)
    for team in range(len(reaches)):
        begin, count = int(p.first[team]), int(p.first[team + 1] - p.first[team])
        for receiver in range(count):
            row = int(p.members[begin + receiver])
            for index in range(count):
                other = int(p.members[begin + index])
                age = int(p.rows[row, c.ROW_HEARD + index])
                age = age + 1 if age >= 0 else -1
                dx = nearest_image(p.own[other, 0, c.X] - p.own[row, 0, c.X], p.extent[0])
                dy = nearest_image(p.own[other, 0, c.Y] - p.own[row, 0, c.Y], p.extent[1])
                dz = nearest_image(p.own[other, 0, c.Z] - p.own[row, 0, c.Z], p.extent[2])
                lost = losses[team] >= 1.0 or (losses[team] > 0.0 and draws[other, receiver] < losses[team])
                if not lost and dx * dx + dy * dy + dz * dz <= reaches[team] * reaches[team]:
                    age = 0
                remembered = p.rows[row, c.ROW_POSES] > 0 and age < p.rows[other, c.ROW_POSES]
                p.rows[row, c.ROW_HEARD + index] = age if remembered else -1
