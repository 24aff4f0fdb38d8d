"""What depositing mechanisms leave behind: one static gradient at the own pose of each row."""

from dataclasses import dataclass

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.buffer import SoBuffer
from selforg.columns import (
    DIFFUSION,
    FACTOR,
    GOAL,
    GRADIENT_COLUMNS,
    PERIOD,
    TAG_CHANNEL,
    TAG_COLUMNS,
    TAG_SIGN,
)
from selforg.gradient import check_fields


@dataclass(frozen=True)
class Pheromone:
    """A pheromone: `attraction` (-1, 0, 1), `diffusion` [m], evaporation (factor [-], period [s]) on a channel.

    It has no goal area and no heading (Q14).
    """

    channel: str = "Pheromone"
    attraction: int = 1
    diffusion: float = 1.0
    evaporation_factor: float = 0.9
    evaporation_period: float = 5.0

    def __post_init__(self) -> None:
        """Check every field."""
        check_fields(
            np.zeros(2), self.attraction, self.diffusion, 0.0, self.evaporation_factor, self.evaporation_period, 0.0
        )


class Depositor:
    """Spreads one pheromone from the own pose of many rows at once."""

    def __init__(self, buffer: SoBuffer, pheromone: Pheromone) -> None:
        self._buffer = buffer
        self._message: Floats = np.zeros(GRADIENT_COLUMNS)
        self._message[[DIFFUSION, GOAL]] = pheromone.diffusion, 0.0
        self._message[[FACTOR, PERIOD]] = pheromone.evaporation_factor, pheromone.evaporation_period
        self._tag: Ints = np.zeros(TAG_COLUMNS, dtype=np.int64)
        self._tag[TAG_CHANNEL] = buffer.channel_code(pheromone.channel)
        self._tag[TAG_SIGN] = pheromone.attraction

    def deposit(self, now: float, rows: Ints) -> None:
        """Store the pheromone at the newest pose of each of `rows` (R,) at `now` [s]; rows without a pose leave none."""
        self._buffer.deposit(rows, self._message, self._tag, now)
