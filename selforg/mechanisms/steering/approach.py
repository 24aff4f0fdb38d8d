"""Approaching the goal that is near and little crowded, and waiting before it."""

from typing import Unpack

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.commands import Commanded
from selforg.compiler.records import Words
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import ATTRACTIVE, Filter, Queries
from selforg.mechanisms.base import at_least
from selforg.mechanisms.kernels.approaching import APPROACHING, Approaching, approach_rows
from selforg.mechanisms.kernels.others import OTHER_COLUMNS
from selforg.mechanisms.options import LookOptions
from selforg.mechanisms.registry import MECHANISMS
from selforg.mechanisms.steering.base import SteeringMechanism


@MECHANISMS.register
class ApproachLeastBusy(SteeringMechanism):
    """To the attractive gradient of least way, where each robot before it is worth some way; waiting before a busy one.

    A robot is before a gradient if it is nearer to it than the one that chooses, and within `crowd` of it, for the
    choice, or within `lane`, for waiting. Robots are known by the poses that were received. One that waits turns
    towards the gradient.

    Args:
        buffer: of the gradients.
        weight: way that a robot before a gradient is worth [m]; 0: the nearest gradient is taken.
        crowd: distance from a gradient up to which robots count for the choice [m].
        loyalty: way by which another gradient must be better than the one chosen before [m].
        halt: distance from its gradient up to which a robot may have to wait [m]; 0: none waits.
        lane: distance from a gradient within which a robot makes others wait [m].
        patience: longest time for which a robot waits before it goes on [s].
        **options: see `SteeringMechanism`; `view_distance` is that up to which gradients and robots are known.

    """

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        weight: float = 0.0,
        crowd: float = 3.0,
        loyalty: float = 1.0,
        halt: float = 0.0,
        lane: float = 1.0,
        patience: float = 20.0,
        **options: Unpack[LookOptions],
    ) -> None:
        super().__init__(buffer, **options)
        rows = self.poses.rows
        self._queries = Queries(self.buffer)
        self._look = Filter(self.channels, moving=False, view_distance=self.view_distance)
        self._places: Floats = np.zeros((rows, 2))
        self._times: Floats = np.full((rows, 2), -np.inf)
        self._approaching = APPROACHING.pack(
            Approaching(
                others=np.zeros((rows, OTHER_COLUMNS)),
                places=self._places,
                times=self._times,
                view_distance=self.view_distance,
                weight=at_least(self, "weight", weight, 0.0),
                crowd=at_least(self, "crowd", crowd, 0.0),
                loyalty=at_least(self, "loyalty", loyalty, 0.0),
                halt=at_least(self, "halt", halt, 0.0),
                lane=at_least(self, "lane", lane, 0.0),
                patience=at_least(self, "patience", patience, 0.0),
            )
        )

    def steer(self, now: float, rows: Ints, commands: Words[Commanded]) -> None:
        """Change the commands of `rows` (K,), all different, at `now` [s]."""
        goals = self._queries.gather(now, rows, self._look, signs=ATTRACTIVE)
        poses = self.poses.packed.words
        approach_rows(now, rows, goals.start, goals.pairs, commands, self._approaching.words, poses)

    def reset(self, rows: Ints) -> None:
        """Forget what `rows` (K,) chose, and that they wait."""
        self._times[rows] = -np.inf
