"""Mechanisms that deposit: they leave a static gradient at the own pose while they move by another rule."""

from dataclasses import dataclass
from typing import Unpack, final

import numpy as np
import numpy.typing as npt

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import check_fields
from selforg.mechanisms.base import MECHANISMS, SpeedOptions
from selforg.mechanisms.chemotaxis import ChemotaxisGe
from selforg.mechanisms.exploration import Exploration
from selforg.mechanisms.following import AvoidAll, FollowMinReach
from selforg.mechanisms.formula import FormulaMechanism
from selforg.mechanisms.movement import REFLECT
from selforg.mechanisms.spreading import Carried, Spreader
from selforg.program import Program, Rows


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


class DepositingMechanism(FormulaMechanism):
    """A movement mechanism that also deposits: call `deposit` after `move`, which must not see it in the same tick.

    Attributes:
        spreader: gives the steps of a program that do as `deposit` does.

    """

    def __init__(self, buffer: SoBuffer, *, pheromone: Pheromone, **options: Unpack[SpeedOptions]) -> None:
        super().__init__(buffer, **options)
        self.spreader = Spreader(self.buffer, Carried(key="", moving=False, **vars(pheromone)))

    @final
    def deposit(self, now: float, rows: npt.NDArray[np.integer] | None = None) -> None:
        """Leave the pheromone at the newest pose of each of `rows` (R,) (None: all) at `now` [s].

        Rows without a pose leave none.
        """
        chosen = Rows.of(self.poses.chosen(rows))
        Program(lambda: self.spreader.depositing(chosen)).run(float(now))


@MECHANISMS.register
class DepositPheromones(DepositingMechanism):
    """ChemotaxisGe by static gradients only while depositing a pheromone, of diffusion `max_speed` unless given."""

    combine = staticmethod(ChemotaxisGe.combine)
    looks = ChemotaxisGe.looks
    wakes = ChemotaxisGe.wakes
    min_speed = 0.5

    def __init__(
        self, buffer: SoBuffer, *, pheromone: Pheromone | None = None, **options: Unpack[SpeedOptions]
    ) -> None:
        speed = options.get("max_speed")
        pheromone = pheromone or Pheromone(diffusion=self.max_speed if speed is None else speed)
        options = {"moving": False, **options}
        super().__init__(buffer, pheromone=pheromone, **options)


DepositPheromonesMin = DepositPheromones.variant(
    "DepositPheromonesMin",
    "FollowMinReach while depositing.",
    combine=FollowMinReach.combine,
    looks=FollowMinReach.looks,
    wakes=FollowMinReach.wakes,
    chooses=FollowMinReach.chooses,
)
DepositPheromonesRandom = DepositPheromones.variant(
    "DepositPheromonesRandom",
    "Exploration while depositing.",
    combine=Exploration.combine,
    looks=Exploration.looks,
    wakes=Exploration.wakes,
    walls=Exploration.walls,
    min_speed=0.1,
)


@MECHANISMS.register
class Patrol(DepositingMechanism):
    """Moves away from all gradients of its channels and leaves a repulsive pheromone with each command.

    Where the repulsions are zero or cancel out, the direction is random, at `max_speed` (deviation Q7: the original
    replaces every vector that needs no limiting). Inactive where no gradient is in view.
    """

    formula = staticmethod(AvoidAll.formula)
    looks = AvoidAll.looks
    wakes = AvoidAll.wakes
    walls = REFLECT
    random = True
    min_speed = 0.7

    def __init__(
        self, buffer: SoBuffer, *, pheromone: Pheromone | None = None, **options: Unpack[SpeedOptions]
    ) -> None:
        super().__init__(buffer, pheromone=pheromone or Pheromone(attraction=-1, evaporation_period=30.0), **options)
