"""The ground of a world: a torus, or open land. Robots start around its middle.

Open land has no edge. Physics works on a torus so wide that no robot gets round it within the mission, and all sensors
and measures use Euclidean offsets.
"""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.world import GroundKind
from selforg.arrays import READ, Floats
from selforg.space import Euclidean, Space, Torus


@dataclass(frozen=True)
class Ground:
    """A torus, or the open land around a rectangle in which robots start.

    Attributes:
        kind: torus or open.
        size: (2,) of the torus, or of that rectangle [m].
        extent: (2,) of the torus of the physics [m].
        space: the metric of sensors and measures.

    """

    kind: GroundKind
    size: Annotated[Floats, "2", READ]
    extent: Annotated[Floats, "2", READ]
    space: Annotated[Space, READ] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Choose the metric."""
        object.__setattr__(self, "space", Torus(*self.extent.tolist()) if self.kind == "torus" else Euclidean(2))

    @classmethod
    def of(cls, mission: MissionConfig) -> "Ground":
        """Return the ground of a mission."""
        world = mission.world
        return cls(world.ground, np.array([world.width, world.height]), np.array(mission.extent))

    @property
    def centre(self) -> Floats:
        """Middle of the ground (2,) [m]."""
        return 0.5 * self.extent

    @property
    def corner(self) -> Floats:
        """Lower left corner of the torus, or of the rectangle in which robots start, (2,) [m]."""
        return 0.5 * (self.extent - self.size)

    @property
    def longest(self) -> float:
        """Distance that counts as far [m]: half the diagonal of the torus, or the diagonal of the rectangle."""
        diagonal = float(np.sqrt((self.size * self.size).sum()))
        return 0.5 * diagonal if self.kind == "torus" else diagonal

    def offsets(self, origin: Floats, target: Floats) -> Floats:
        """Return the shortest way (..., 2) [m] from `origin` (..., 2) to `target` (..., 2)."""
        return self.space.offsets(origin, target)

    def distances(self, origin: Floats, target: Floats) -> Floats:
        """Return the lengths (...) [m] of those ways."""
        distances: Floats = np.linalg.norm(self.offsets(origin, target), axis=-1)
        return distances
