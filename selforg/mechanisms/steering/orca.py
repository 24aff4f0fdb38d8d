"""Optimal reciprocal collision avoidance by half-planes of velocities."""

from typing import Unpack

import numpy as np

from selforg.arrays import Ints
from selforg.commands import Commanded
from selforg.compiler.records import Words
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.mechanisms.base import at_least
from selforg.mechanisms.kernels.half_planes import HALF_PLANES, LINE_COLUMNS, HalfPlanes, avoid_rows
from selforg.mechanisms.kernels.others import OTHER_COLUMNS
from selforg.mechanisms.options import LookOptions
from selforg.mechanisms.registry import MECHANISMS
from selforg.mechanisms.steering.base import SteeringMechanism


@MECHANISMS.register
class ORCA(SteeringMechanism):
    """Optimal reciprocal collision avoidance of van den Berg, Guy, Lin & Manocha (2011).

    doi:10.1007/978-3-642-19457-3_1. Each other robot permits a half-plane of velocities, which avoids a collision for
    `horizon` if both take half of the change. The permitted velocity nearest to the commanded one is taken, by a linear
    program; if there is none, the one that violates the worst half-plane least. As in the paper, robots are taken to
    follow any velocity at once. The commanded speed is the largest.

    Args:
        buffer: of the robots, or their poses.
        distance: sum of the radii of two robots [m].
        horizon: time for which no collision is permitted [s].
        period: time within which robots that overlap have to part [s].
        **options: see `SteeringMechanism`.

    """

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        distance: float = 0.65,
        horizon: float = 2.0,
        period: float = 0.2,
        **options: Unpack[LookOptions],
    ) -> None:
        super().__init__(buffer, **options)
        rows = self.poses.rows
        self._planes = HALF_PLANES.pack(
            HalfPlanes(
                others=np.zeros((rows, OTHER_COLUMNS)),
                lines=np.zeros((rows, LINE_COLUMNS)),
                projected=np.zeros((rows, LINE_COLUMNS)),
                found=np.zeros(2),
                view_distance=self.view_distance,
                distance=at_least(self, "distance", distance, 0.0),
                horizon=at_least(self, "horizon", horizon, 1e-6),
                period=at_least(self, "period", period, 1e-6),
            )
        )

    def steer(self, now: float, rows: Ints, commands: Words[Commanded]) -> None:
        """Change the commands of `rows` (K,), all different, at `now` [s]."""
        avoid_rows(now, rows, commands, self._planes.words, self.poses.packed.words)
