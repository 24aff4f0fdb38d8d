"""Typed configuration of the ground and its physics."""

import math
from typing import Literal, Self

from pydantic import model_validator

from clean_swarm_env.config.types import Length, Rate
from selector.documents.errors import impossible
from selector.documents.fields import Closed

MAX_COVERED_SHARE = 0.45
"""Largest share of the torus that solid discs may cover [-]; random sequential placement ends at 0.547."""

MOST_STEPS = 1000
"""Physics steps of a control period, between which a mission cannot be interrupted."""


GroundKind = Literal["torus", "open"]


class WorldConfig(Closed):
    """The ground and its physics."""

    ground: GroundKind = "torus"
    """Whether the world is a torus, or open land that has no edge; cleaning is for a torus."""
    width: Length = 11.0
    """Length of the torus along x, or of the part of open land in which robots start [m]."""
    height: Length = 11.0
    """Length along y [m]."""
    contacts: Literal["solid", "pass_through"] = "solid"
    """Whether robots are solid, or drive through each other as in the paper's simulator."""
    physics_rate: Rate = 20.0
    """Physics steps per second, which is also the sampling rate of collisions [Hz]."""
    control_rate: Rate = 5.0
    """Decisions of every robot per second [Hz]; the physics rate is a whole multiple of it."""

    @model_validator(mode="after")
    def _whole_steps(self) -> Self:
        ratio = self.physics_rate / self.control_rate
        if ratio > MOST_STEPS:
            raise impossible("physics_rate", f"at most {MOST_STEPS} steps in a control period", self.physics_rate)
        if round(ratio) < 1 or abs(ratio - round(ratio)) > 1e-9:
            expected = f"a rate that divides physics_rate {self.physics_rate:g} Hz into whole steps"
            raise impossible("control_rate", expected, self.control_rate)
        return self

    @property
    def physics_steps_per_tick(self) -> int:
        """Number of physics steps in one control period."""
        return round(self.physics_rate / self.control_rate)


def robots_that_fit(world: WorldConfig, radius: float, largest: float = 0.0) -> int:
    """Return the number of solid discs of a mean `radius` [m] for which random placement finds room.

    largest: radius of the largest of them [m], if they differ.
    """
    if min(world.width, world.height) < 4.0 * max(radius, largest):  # a disc would touch its own image across the seam
        return 0
    return int(MAX_COVERED_SHARE * world.width * world.height / (math.pi * radius**2))
