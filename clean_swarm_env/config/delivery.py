"""How well the messages of robots reach the others: range, message loss, delay, memory."""

from typing import Annotated

from pydantic import Field

from selector.documents.fields import Closed, Flag, Positive, Share

EVERYWHERE = 1e9
"""Range of a message that all robots receive [m]."""


class DeliveryConfig(Closed):
    """Range, losses and delay of the robots' messages: their poses and pheromones."""

    reach: Positive = EVERYWHERE
    """Farthest receiver of a message [m]."""
    loss: Share = 0.0
    """Probability that a receiver misses a message, drawn for each receiver [-]."""
    delay: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=60.0)] = 0.0
    """Time from sending a message to its arrival [s]; a whole multiple of the control period."""
    pose_memory: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=3600.0)] = 1.0
    """Time for which a robot keeps the last pose it received from another one, from its arrival on [s]."""
    own_contents: Flag = False
    """Whether each robot stores its own messages even if none is ever lost; it costs time."""

    @property
    def ideal(self) -> bool:
        """Whether every robot receives everything at once."""
        return self.reach >= EVERYWHERE and self.loss == 0.0 and self.delay == 0.0
