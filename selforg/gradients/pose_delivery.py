"""Delivery of poses: which rows have received whose poses, and how old these are.

When messages have a range and get lost, no pose is copied: the table of rows has a column for each member of the team,
with the age, in the history of that member, of the last pose received from it, and one with the age of the pose
received before that. A row that looks at poses begins with the first of them.
"""

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from selforg.arrays import SCRATCH, Floats
from selforg.compiler.decorators import kernel
from selforg.compiler.records import Written
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.space import squared_length


class PoseDelivery:
    """Delivers poses among the rows of `poses`; call `deliver` after each update of the poses.

    Attributes:
        reaches: (T,) farthest receiver in each team [m]; the owner may change it.
        losses: (T,) probability that a receiver misses a pose, in each team; the owner may change it.
        generators: one for each row, for the losses of what it spreads; the owner may change it.
        delay: age of a pose on its arrival [updates].

    Raises:
        ValueError: poses that were not made with `hearing`.

    """

    _draws: Annotated[Floats, "N MEMBERS", SCRATCH]

    def __init__(
        self,
        poses: OwnPoses,
        reaches: Floats,
        losses: Floats,
        generators: Sequence[np.random.Generator],
        delay: int = 0,
    ) -> None:
        if poses.row_table.shape[1] == c.ROW_HEARD:
            raise ValueError("PoseDelivery: the poses must be made with hearing=True")
        if not 0 <= delay < max(poses.history, 1):
            raise ValueError(f"PoseDelivery: delay must lie in the history of {poses.history} poses, got {delay!r}")
        self.poses, self.delay = poses, delay
        self.reaches, self.losses, self.generators = reaches, losses, generators
        self._draws = np.zeros((poses.rows, (poses.row_table.shape[1] - c.ROW_HEARD) // 2))

    def deliver(self) -> None:
        """Deliver the pose of each row that arrives now to the other rows in range, unless it gets lost.

        Losses are drawn, and ranges measured from where the pose was sent, on its arrival.
        """
        lossy = (self.losses > 0.0) & (self.losses < 1.0)
        if lossy.any():
            for row in np.flatnonzero(lossy[self.poses.teams] & self.poses.known).tolist():
                self._draws[row] = self.generators[row].random(self._draws.shape[1])
        deliver_poses(self.poses.packed.words, self.reaches, self.losses, self._draws, self.delay)


@kernel
def deliver_poses(poses: Written[Poses], reaches: Floats, losses: Floats, draws: Floats, delay: int) -> None:
    """Write for each pair of a team the ages of the last two poses received, -1 for none that is still remembered.

    reaches (T,) [m], losses (T,), draws (N, most members) uniform in [0, 1) of the row that spreads, delay [updates].
    """
    p = open_poses(poses)
    room = (p.rows.shape[1] - c.ROW_HEARD) // 2
    for team in range(len(reaches)):
        begin, count = int(p.first[team]), int(p.first[team + 1] - p.first[team])
        for receiver in range(count):
            row = int(p.members[begin + receiver])
            for index in range(count):
                other = int(p.members[begin + index])
                age, before = int(p.rows[row, c.ROW_HEARD + index]), int(p.rows[row, c.ROW_HEARD + room + index])
                age, before = age + 1 if age >= 0 else -1, before + 1 if before >= 0 else -1
                dx = p.own[other, delay, c.X] - p.own[row, 0, c.X]
                dy = p.own[other, delay, c.Y] - p.own[row, 0, c.Y]
                dz = p.own[other, delay, c.Z] - p.own[row, 0, c.Z]
                lost = losses[team] >= 1.0 or (losses[team] > 0.0 and draws[other, receiver] < losses[team])
                if not lost and squared_length(dx, dy, dz, p.extent) <= reaches[team] * reaches[team]:
                    age, before = delay, age
                known = p.rows[other, c.ROW_POSES] if p.rows[row, c.ROW_POSES] > 0 else 0
                p.rows[row, c.ROW_HEARD + index] = age if age < known else -1
                p.rows[row, c.ROW_HEARD + room + index] = before if before < known else -1
