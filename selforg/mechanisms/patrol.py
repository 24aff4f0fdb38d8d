"""Patrol: repulsive pheromones keep robots away from where somebody has been."""

from collections.abc import Iterable
from typing import final

import numpy as np
import numpy.typing as npt

from selforg.buffer import SoBuffer
from selforg.mechanisms.base import RuleMechanism
from selforg.mechanisms.depositing import Depositor, Pheromone
from selforg.mechanisms.registry import register
from selforg.randomness import DirectionStream
from selforg.rules import AVOID_ALL, RANDOM_IF_ZERO


@register
class Patrol(RuleMechanism):
    """Moves away from all gradients of its channels and leaves a repulsive pheromone with each command.

    Where the repulsions are zero or cancel out, the direction is random, at `max_speed` (deviation Q7: the original
    replaces every vector that needs no limiting). Inactive where no gradient is in view.
    """

    rule = AVOID_ALL

    def __init__(
        self,
        buffer: SoBuffer,
        *,
        pheromone: Pheromone | None = None,
        min_speed: float = 0.7,
        max_speed: float = 1.0,
        channels: Iterable[str] = (),
        view_distance: float | None = None,
        moving: bool = True,
        static: bool = True,
        directions: DirectionStream | None = None,
    ) -> None:
        super().__init__(
            buffer, min_speed=min_speed, max_speed=max_speed, channels=channels, view_distance=view_distance,
            moving=moving, static=static, directions=directions,
        )  # fmt: skip
        self._parameters[RANDOM_IF_ZERO] = 1.0
        self.pheromone = pheromone or Pheromone(attraction=-1, diffusion=1.0, evaporation_period=30.0)
        self._depositor = Depositor(self.buffer, self.pheromone)

    @final
    def deposit(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> None:
        """Leave the pheromone at the own pose of each of `rows` (R,) (None: all), after all have moved."""
        rows = self._all_rows if rows is None else np.ascontiguousarray(rows, dtype=np.int64)
        self._depositor.deposit(float(now), rows)
