"""Terms about the other robots: the nearest one, how many there are, and what they carry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clean_swarm_env.learning.observation.around import Around, write_way
from clean_swarm_env.learning.observation.term import TERMS, CompiledTerm, Observed
from clean_swarm_env.world.garbage import NOTHING
from selforg.arrays import Floats
from selforg.compiler.decorators import inlined
from selforg.elementary import sine_cosine
from selforg.space import nearest_image


@TERMS.register
class NeighbourTerm(CompiledTerm):
    """The share of the other robots within the largest neighbour range, and the way to the nearest by that range."""

    name = "neighbour"
    components = ("neighbours", "neighbour_distance", "neighbour_ahead", "neighbour_left")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        last = around.ranges.shape[0] - 1
        out[1] = 1.0
        if around.neighbour[row] >= 0:
            out[0] = around.within[row, last] / (around.team[row // around.robots] - 1)
            write_way(around, row, around.positions[around.neighbour[row]], around.ranges[last], out[1:])


@TERMS.register
class EncounterTerm(CompiledTerm):
    """The nearest neighbour: its heading in the robot's frame, how fast it comes closer by twice the largest speed,
    whether it carries something.
    """  # noqa: D205

    name = "encounter"
    components = ("neighbour_heading_ahead", "neighbour_heading_left", "neighbour_closing", "neighbour_carries")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        other = around.neighbour[row]
        if other < 0:
            return
        turned = around.headings[other] - around.headings[row]
        sine, cosine = sine_cosine(turned)
        out[0], out[1], out[3] = cosine, sine, around.cargo[other] != NOTHING
        dx = nearest_image(around.positions[other, 0] - around.positions[row, 0], around.extent[0])
        dy = nearest_image(around.positions[other, 1] - around.positions[row, 1], around.extent[1])
        length = np.sqrt(dx * dx + dy * dy)
        if length > 0.0:
            vx, vy = around.bodies[row, 2] - around.bodies[other, 2], around.bodies[row, 3] - around.bodies[other, 3]
            closing = vx * (dx / length) + vy * (dy / length)
            out[2] = min(max(closing / (2.0 * around.max_speed), -1.0), 1.0)


@TERMS.register
class CrowdTerm(CompiledTerm):
    """Robots within each of `neighbour_ranges`, by `full_crowd`, whatever the size of the team."""

    name = "crowd"

    def __init__(self, observed: Observed, *, neighbour_ranges: Sequence[float]) -> None:
        super().__init__(observed)
        self.components = tuple(f"crowd_{distance:g}m" for distance in neighbour_ranges)

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        for k in range(around.ranges.shape[0]):
            out[k] = min(around.within[row, k] / around.full_crowd, 1.0)


@TERMS.register
class CarriersTerm(CompiledTerm):
    """Robots with cargo within the largest neighbour range, by `full_crowd`."""

    name = "carriers"
    components = ("carriers",)

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        out[0] = min(around.carriers[row] / around.full_crowd, 1.0)


@TERMS.register
class DensityTerm(CompiledTerm):
    """Share of the torus within 1 m of the robots, if they were far apart."""

    name = "density"
    components = ("density",)

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        out[0] = min(around.team[row // around.robots] * around.area, 1.0)
