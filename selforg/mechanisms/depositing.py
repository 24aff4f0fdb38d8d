"""Mechanisms that deposit: they leave a static gradient at the own pose while they move by another rule."""

from dataclasses import dataclass
from typing import Annotated, Unpack, final

import numpy as np
import numpy.typing as npt

from selforg.arrays import READ, Floats, Ints
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import check_fields
from selforg.gradients.store import columns as c
from selforg.mechanisms.base import RuleMechanism
from selforg.mechanisms.kernels.rules import chemotaxis_ge, follow_least_reach, wander
from selforg.mechanisms.options import SpeedOptions
from selforg.mechanisms.registry import MECHANISMS


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
        check_fields(self.attraction, self.diffusion, 0.0, self.evaporation_factor, self.evaporation_period, stamp=0.0)


class DepositingMechanism(RuleMechanism):
    """A movement mechanism that also deposits: call `deposit` after `move`, which must not see it in the same tick."""

    _message: Annotated[Floats, "MESSAGE", READ]
    _tag: Annotated[Ints, "TAG", READ]

    def __init__(self, buffer: SoBuffer, *, pheromone: Pheromone, **options: Unpack[SpeedOptions]) -> None:
        super().__init__(buffer, **options)
        self.pheromone = pheromone
        self._message = np.zeros(c.MESSAGE_COLUMNS)
        self._message[c.DIFFUSION] = pheromone.diffusion
        self._message[c.MESSAGE_FAR + c.FAR_FACTOR] = pheromone.evaporation_factor
        self._message[c.MESSAGE_FAR + c.FAR_PERIOD] = pheromone.evaporation_period
        self._tag = np.zeros(c.TAG_COLUMNS, dtype=np.int64)
        self._tag[c.TAG_CHANNEL] = self.buffer.channel_code(pheromone.channel)
        self._tag[c.TAG_SIGN] = pheromone.attraction
        self._tag[c.TAG_KEY] = -1

    @final
    def deposit(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> None:
        """Leave the pheromone at the newest pose of each of `rows` (R,) (None: all) at `now` [s].

        Rows without a pose leave none.
        """
        rows = self._all_rows if rows is None else np.ascontiguousarray(rows, dtype=np.int64)
        self.buffer.deposit(rows, self._message, self._tag, float(now))


class TrailMechanism(DepositingMechanism):
    """What the deposit family shares: static gradients only, and a pheromone whose diffusion is `max_speed`."""

    def __init__(
        self, buffer: SoBuffer, *, pheromone: Pheromone | None = None, **options: Unpack[SpeedOptions]
    ) -> None:
        pheromone = pheromone or Pheromone(diffusion=options.get("max_speed", 1.0))
        options = {"min_speed": 0.5, "moving": False, **options}
        super().__init__(buffer, pheromone=pheromone, **options)


@MECHANISMS.register
class DepositPheromones(TrailMechanism):
    """ChemotaxisGe while depositing."""

    rule = chemotaxis_ge


@MECHANISMS.register
class DepositPheromonesMin(TrailMechanism):
    """FollowMinReach while depositing."""

    rule = follow_least_reach


@MECHANISMS.register
class DepositPheromonesRandom(TrailMechanism):
    """Exploration while depositing."""

    rule = wander

    def __init__(
        self, buffer: SoBuffer, *, pheromone: Pheromone | None = None, **options: Unpack[SpeedOptions]
    ) -> None:
        options = {"min_speed": 0.1, **options}
        super().__init__(buffer, pheromone=pheromone, **options)
