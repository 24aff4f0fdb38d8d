"""The blueprint of a mechanism that is one formula."""

from typing import ClassVar, Unpack

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.buffer import SoBuffer
from selforg.columns import PAIR_COLUMNS
from selforg.mechanisms.base import MovementMechanism, at_least
from selforg.mechanisms.options import MoveOptions
from selforg.poses import OwnPoses
from selforg.walking import Formula, make_walk


class FormulaMechanism(MovementMechanism):
    """A movement mechanism that sums one formula of one pair; subclasses set `formula`.

    `formula` is a function of (distance, own goal radius, own reach, diffusion, goal radius [m], attraction), compiled
    with `selforg.compiled.kernel`; see `selforg.walking`. It must not return NaN.

    Example:
        >>> @kernel
        ... def spring(distance, own_goal, own_reach, diffusion, goal, attraction):
        ...     return distance - own_reach
        >>> @register
        ... class Spring(FormulaMechanism):
        ...     formula = spring

    """

    formula: ClassVar[Formula]

    def __init__(
        self,
        buffer: SoBuffer | OwnPoses,
        *,
        min_speed: float = 0.0,
        max_speed: float = 1.0,
        **options: Unpack[MoveOptions],
    ) -> None:
        super().__init__(buffer, **options)
        self.min_speed = at_least(self, "min_speed", min_speed, 0.0)
        self.max_speed = at_least(self, "max_speed", max_speed, 0.0)
        self._walk = make_walk(type(self).formula)
        self._pairs: Floats = np.empty((256, PAIR_COLUMNS))

    def _move(self, now: float, rows: Ints, vectors: Floats, active: Flags) -> None:
        buffer, directions = self.buffer, self.directions
        if buffer.settings.whole_seconds:
            buffer.evaporate(now)
        directions.refill()
        channels, done = self._channels_now(), 0
        while done < len(rows):
            done, low = self._walk(
                done, now, self._see, self.view_distance, self.min_speed, self.max_speed, rows, channels,
                self.poses.tables, buffer.tables, directions.vectors, directions.cursor, self._pairs, vectors, active,
            )  # fmt: skip
            directions.low |= low
            if done < len(rows):
                self._pairs = np.empty((2 * len(self._pairs), PAIR_COLUMNS))
