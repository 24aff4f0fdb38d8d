"""Typed configuration of the ground and its physics."""

from typing import Annotated, Literal, Self, get_args

import numpy as np
from pydantic import Field, model_validator

from clean_swarm_env.config.types import Length, Point, Rate
from selector.documents.errors import impossible
from selector.documents.fields import Closed, Flag, Name, Share
from selforg.arrays import Floats

MOST_STEPS = 1000
"""Physics steps of a control period, between which a mission cannot be interrupted."""


GroundKind = Literal["torus", "open", "walled"]


Blocked = Literal["sight", "messages", "pheromones"]


class WallConfig(Closed):
    """A wall along straight lines from corner to corner, which bodies cannot cross; it has no thickness."""

    corners: Annotated[tuple[Point, ...], Field(min_length=2, max_length=1000)]
    """Where the wall begins, bends and ends [m]."""
    closed: Flag = False
    """Whether it returns to its first corner; nothing is inside then."""

    @property
    def segments(self) -> Floats:
        """Its pieces (K, 4), x and y of either end [m]."""
        corners = np.array(self.corners)
        pieces = np.concatenate([corners, np.roll(corners, -1, axis=0)], axis=1)
        return pieces if self.closed else pieces[:-1]


class ZoneConfig(Closed):
    """A rectangle of the ground in which messages are lost or robots are slow; where zones overlap the worse counts."""

    name: Name
    """Name of the zone in pictures."""
    area: tuple[Point, Point]
    """Lower left and upper right corner [m]."""
    loss: Share = 0.0
    """Probability that a receiver misses a message from or to a robot inside [-]."""
    speed: Annotated[float, Field(strict=True, ge=0.01, le=1.0)] = 1.0
    """Share of its largest speed that a robot has inside [-]."""

    @model_validator(mode="after")
    def _does_something(self) -> Self:
        if self.loss == 0.0 and self.speed == 1.0:
            raise impossible("loss", "a loss above 0, or a speed below 1", "a zone that does nothing")
        return self


class WorldConfig(Closed):
    """The ground and its physics."""

    ground: GroundKind = "torus"
    """Whether the world is a torus, a field with a wall around it, or open land that has no edge; no cleaning there."""
    width: Length = 11.0
    """Length of the torus or the field along x, or of the part of open land in which robots start [m]."""
    height: Length = 11.0
    """Length along y [m]."""
    walls: Annotated[tuple[WallConfig, ...], Field(max_length=1000)] = ()
    """Walls inside of the torus, the field, or the part of open land in which robots start."""
    walls_block: Annotated[tuple[Blocked, ...], Field(max_length=len(get_args(Blocked)))] = ()
    """What walls block besides bodies: `sight`, so that robots see no items behind them; `messages` between robots;
    `pheromones`, so that robots sense none behind them."""
    zones: Annotated[tuple[ZoneConfig, ...], Field(max_length=100)] = ()
    """Zones in which messages are lost or robots are slow."""
    contacts: Literal["solid", "pass_through"] = "solid"
    """Whether robots are solid, or drive through each other as in the paper's simulator."""
    physics_rate: Rate = 20.0
    """Physics steps per second, which is also the sampling rate of collisions [Hz].

    A mission raises it where robots are so fast or small that they would get through walls or each other.
    """
    control_rate: Rate = 5.0
    """Decisions of every robot per second [Hz]; the physics rate is a whole multiple of it."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        ratio = self.physics_rate / self.control_rate
        if ratio > MOST_STEPS:
            raise impossible("physics_rate", f"at most {MOST_STEPS} steps in a control period", self.physics_rate)
        if round(ratio) < 1 or abs(ratio - round(ratio)) > 1e-9:
            expected = f"a rate that divides physics_rate {self.physics_rate:g} Hz into whole steps"
            raise impossible("control_rate", expected, self.control_rate)
        for k, zone in enumerate(self.zones):
            (left, bottom), (right, top) = zone.area
            if not (0.0 <= left < right <= self.width and 0.0 <= bottom < top <= self.height):
                expected = f"a lower left and an upper right corner on {self.width:g} m x {self.height:g} m"
                raise impossible(f"zones.{k}.area", expected, [list(corner) for corner in zone.area])
        return self

    @property
    def has_walls(self) -> bool:
        """Whether there are walls, that around a field included."""
        return self.ground == "walled" or len(self.walls) > 0

    def blocks(self, what: Blocked) -> bool:
        """Return whether there are walls, and they block `what`."""
        return self.has_walls and what in self.walls_block

    @property
    def physics_steps_per_tick(self) -> int:
        """Number of physics steps in one control period."""
        return round(self.physics_rate / self.control_rate)
