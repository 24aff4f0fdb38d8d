"""Terms about the other robots: the nearest one, how many there are, and what they carry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clean_swarm_env.learning.observation.around import Around, open_around, write_way
from clean_swarm_env.learning.observation.term import TERMS, CompiledTerm, Observed
from clean_swarm_env.world.garbage import NOTHING
from selforg.arrays import Floats
from selforg.compiler.decorators import part
from selforg.compiler.records import Words
from selforg.space import nearest_image


@TERMS.register
class NeighbourTerm(CompiledTerm):
    """The share of the other robots within the largest neighbour range, and the way to the nearest by that range."""

    name = "neighbour"
    needs = ("neighbours",)
    components = ("neighbours", "neighbour_distance", "neighbour_ahead", "neighbour_left")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        robots, last = a.present.shape[0] // a.team.shape[0], a.ranges.shape[0] - 1
        out[1] = 1.0
        if a.neighbour[row] >= 0:
            out[0] = a.within[row, last] / (a.team[row // robots] - 1)
            write_way(a, row, a.positions[a.neighbour[row]], a.ranges[last], out[1:])


@TERMS.register
class EncounterTerm(CompiledTerm):
    """The nearest neighbour: its heading in the robot's frame, how fast it comes closer by twice the largest speed,
    whether it carries something.
    """  # noqa: D205

    name = "encounter"
    needs = ("neighbours",)
    components = ("neighbour_heading_ahead", "neighbour_heading_left", "neighbour_closing", "neighbour_carries")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        other = a.neighbour[row]
        if other < 0:
            return
        turned = a.headings[other] - a.headings[row]
        out[0], out[1], out[3] = np.cos(turned), np.sin(turned), a.cargo[other] != NOTHING
        dx = nearest_image(a.positions[other, 0] - a.positions[row, 0], a.extent[0])
        dy = nearest_image(a.positions[other, 1] - a.positions[row, 1], a.extent[1])
        length = np.sqrt(dx * dx + dy * dy)
        if length > 0.0:
            vx, vy = a.bodies[row, 2] - a.bodies[other, 2], a.bodies[row, 3] - a.bodies[other, 3]
            closing = vx * (dx / length) + vy * (dy / length)
            out[2] = min(max(closing / (2.0 * a.max_speed), -1.0), 1.0)


@TERMS.register
class CrowdTerm(CompiledTerm):
    """Robots within each of `neighbour_ranges`, by `full_crowd`, whatever the size of the team."""

    name = "crowd"
    needs = ("neighbours",)

    def __init__(self, observed: Observed, *, neighbour_ranges: Sequence[float]) -> None:
        super().__init__(observed)
        self.components = tuple(f"crowd_{distance:g}m" for distance in neighbour_ranges)

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        for k in range(a.ranges.shape[0]):
            out[k] = min(a.within[row, k] / a.full_crowd, 1.0)


@TERMS.register
class CarriersTerm(CompiledTerm):
    """Robots with cargo within the largest neighbour range, by `full_crowd`."""

    name = "carriers"
    needs = ("neighbours",)
    components = ("carriers",)

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        out[0] = min(a.carriers[row] / a.full_crowd, 1.0)


@TERMS.register
class DensityTerm(CompiledTerm):
    """Share of the torus within 1 m of the robots, if they were far apart."""

    name = "density"
    components = ("density",)

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        out[0] = min(a.team[row // (a.present.shape[0] // a.team.shape[0])] * a.area, 1.0)
