"""The ground of a world: a torus, a walled field, or open land. Robots start around its middle.

A walled field is the lower left quarter of the torus of the physics. Open land has no edge: its torus is so wide that
no robot gets round it within the mission. On both, all sensors and measures use Euclidean offsets.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from clean_swarm_env.config.free_places import images_of
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.world import GroundKind
from clean_swarm_env.physics.zones import Zones
from selforg.arrays import READ, Floats
from selforg.compiler.records import Packed
from selforg.space import Euclidean, Space, Torus
from selforg.walls.segments import NEAR, Walls, no_walls, packed_walls


@dataclass(frozen=True)
class Ground:
    """A torus, a walled field, or the open land around a rectangle in which robots start.

    Attributes:
        kind: torus, walled or open.
        size: (2,) of the torus or field, or of that rectangle [m].
        extent: (2,) of the torus of the physics [m].
        is_free: whether a robot has room at a place (2,) [m] and can drive from there to the rest of the ground.
        space: the metric of sensors and measures.

    """

    kind: GroundKind
    size: Annotated[Floats, "2", READ]
    extent: Annotated[Floats, "2", READ]
    is_free: Callable[[Floats], bool] = field(default=lambda point: True, repr=False, compare=False)
    space: Annotated[Space, READ] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Choose the metric."""
        object.__setattr__(self, "space", Torus(*self.extent.tolist()) if self.kind == "torus" else Euclidean(2))

    @classmethod
    def of(cls, mission: MissionConfig) -> "Ground":
        """Return the ground of a mission."""
        return cls(mission.world.ground, mission.size, np.array(mission.extent), mission.is_free)

    @property
    def land(self) -> Floats:
        """Width and height (2,) of all ground that robots can reach [m]."""
        return self.size if self.kind == "walled" else self.extent

    @property
    def centre(self) -> Floats:
        """Middle of the ground (2,) [m]."""
        return 0.5 * self.land

    @property
    def corner(self) -> Floats:
        """Lower left corner of the torus or field, or of the rectangle in which robots start, (2,) [m]."""
        return 0.5 * (self.land - self.size)

    @property
    def longest(self) -> float:
        """Distance that counts as far [m]: half the diagonal of the torus, or that of the field or rectangle."""
        diagonal = float(np.sqrt((self.size * self.size).sum()))
        return 0.5 * diagonal if self.kind == "torus" else diagonal

    def offsets(self, origin: Floats, target: Floats) -> Floats:
        """Return the shortest way (..., 2) [m] from `origin` (..., 2) to `target` (..., 2)."""
        return self.space.offsets(origin, target)

    def distances(self, origin: Floats, target: Floats) -> Floats:
        """Return the lengths (...) [m] of those ways."""
        distances: Floats = np.linalg.norm(self.offsets(origin, target), axis=-1)
        return distances


def walls_of(mission: MissionConfig) -> Packed[Walls]:
    """Return the walls of a mission, at their places on the torus of the physics."""
    world, robots = mission.world, mission.robots
    if not world.has_walls:
        return no_walls()
    near = max(NEAR, 2.0 * robots.radius + 2.0 * robots.max_speed / world.control_rate)
    corner = Ground.of(mission).corner
    segments = images_of(world, near) + np.tile(corner, 2)
    beyond = near if world.ground == "open" else 0.0
    low, high = corner - beyond, corner + mission.size + beyond
    return packed_walls(segments, low.tolist(), high.tolist(), near)


def zones_of(mission: MissionConfig) -> Zones:
    """Return the zones of a mission, at their places on the torus of the physics."""
    zones = mission.world.zones
    corners = np.array([[*zone.area[0], *zone.area[1]] for zone in zones]).reshape(-1, 4)
    losses, speeds = np.array([zone.loss for zone in zones]), np.array([zone.speed for zone in zones])
    return Zones(corners + np.tile(Ground.of(mission).corner, 2), losses, speeds)
