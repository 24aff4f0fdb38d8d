"""Patrol: robots move away from the trails of others, and so go where nobody has been lately."""

from typing import Unpack

from selforg.gradients.buffer import SoBuffer
from selforg.mechanisms.base import MECHANISMS, SpeedOptions
from selforg.mechanisms.depositing import DepositingMechanism, Pheromone
from selforg.mechanisms.following import AvoidAll


@MECHANISMS.register
class Patrol(DepositingMechanism):
    """Moves away from all gradients of its channels and leaves a repulsive pheromone with each command.

    Where the repulsions are zero or cancel out, the direction is random, at `max_speed` (deviation Q7: the original
    replaces every vector that needs no limiting). Inactive where no gradient is in view.
    """

    formula = staticmethod(AvoidAll.formula)
    looks = AvoidAll.looks
    wakes = AvoidAll.wakes
    random = True
    min_speed = 0.7

    def __init__(
        self, buffer: SoBuffer, *, pheromone: Pheromone | None = None, **options: Unpack[SpeedOptions]
    ) -> None:
        super().__init__(buffer, pheromone=pheromone or Pheromone(attraction=-1, evaporation_period=30.0), **options)
