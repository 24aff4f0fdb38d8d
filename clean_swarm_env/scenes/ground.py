"""The ground of a scene: a torus, or open land. Both have a square field in their middle in which things are placed.

Open land has no edge for the robots. Physics works on a torus so wide that no robot can get round it within the run,
and all sensors and measures use Euclidean offsets.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from selforg.arrays import Floats
from selforg.space import Euclidean, Space, Torus

GroundKind = Literal["torus", "open"]
SPARE = 2.0
"""Margin around the places that robots can reach on open land [m]."""


@dataclass(frozen=True)
class Ground:
    """A torus with a field of side `field_side` [m] in its middle, or open land around such a field.

    Attributes:
        range: farthest distance from the field that robots can reach on open land [m].
        torus_side: side of the torus [m]; that of the field unless given.
        space: the metric of sensors and measures.
        side: side of the torus of the physics [m].
        corner: lower left corner of the field, x and y alike [m].

    """

    kind: GroundKind
    field_side: float
    range: float = 0.0
    torus_side: float = 0.0
    space: Space = field(init=False, repr=False, compare=False)
    side: float = field(init=False)
    corner: float = field(init=False)

    def __post_init__(self) -> None:
        torus = self.kind == "torus"
        side = max(self.torus_side, self.field_side) if torus else self.field_side + 2.0 * (self.range + SPARE)
        object.__setattr__(self, "side", side)
        object.__setattr__(self, "corner", 0.5 * (side - self.field_side))
        object.__setattr__(self, "space", Torus(side, side) if torus else Euclidean(2))

    @property
    def centre(self) -> Floats:
        """Middle of the field (2,) [m]."""
        return np.full(2, 0.5 * self.side)

    def offsets(self, origin: Floats, target: Floats) -> Floats:
        """Return the shortest way (..., 2) [m] from `origin` (..., 2) to `target` (..., 2)."""
        return self.space.offsets(origin, target)

    def distances(self, origin: Floats, target: Floats) -> Floats:
        """Return the lengths (...) [m] of those ways."""
        distances: Floats = np.linalg.norm(self.offsets(origin, target), axis=-1)
        return distances
