"""Terms about the other robots: the nearest one, how many there are, and what they carry."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clean_swarm_env.learning.observation.around import Around, open_around, write_way
from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from clean_swarm_env.world.garbage import NOTHING
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Words
from selforg.space import nearest_image


@TERMS.register
class NeighbourTerm(Term):
    """The share of the other robots within the largest neighbour range, and the way to the nearest by that range."""

    name = "neighbour"
    needs = ("neighbours",)
    components = ("neighbours", "neighbour_distance", "neighbour_ahead", "neighbour_left")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_neighbour(self.observed.around.words, rows, out[0], out[1:])


@lean_kernel
def write_neighbour(around: Words[Around], rows: Ints, share: Floats, way: Floats) -> None:
    """Write the `share` (R,) of the other robots in range, and the `way` (3, R) to the nearest; see `write_way`."""
    a = open_around(around)
    robots, last = a.present.shape[0] // a.team.shape[0], a.ranges.shape[0] - 1
    for row in rows:
        way[0, row] = 1.0
        if a.neighbour[row] >= 0:
            share[row] = a.within[last, row] / (a.team[row // robots] - 1)
            write_way(a, row, a.positions[a.neighbour[row]], a.ranges[last], way)


@TERMS.register
class EncounterTerm(Term):
    """The nearest neighbour: its heading in the robot's frame, how fast it comes closer by twice the largest speed,
    whether it carries something.
    """  # noqa: D205

    name = "encounter"
    needs = ("neighbours",)
    components = ("neighbour_heading_ahead", "neighbour_heading_left", "neighbour_closing", "neighbour_carries")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        worlds = self.observed.worlds
        fastest = 2.0 * worlds.mission.robots.max_speed
        write_encounter(self.observed.around.words, rows, worlds.physics.velocities, fastest, out)


@lean_kernel
def write_encounter(around: Words[Around], rows: Ints, velocities: Floats, fastest: float, out: Floats) -> None:
    """Write the components of `EncounterTerm` into `out` (4, R); velocities (R, 2) and the `fastest` approach [m/s]."""
    a = open_around(around)
    for row in rows:
        other = a.neighbour[row]
        if other < 0:
            continue
        turned = a.headings[other] - a.headings[row]
        out[0, row], out[1, row] = np.cos(turned), np.sin(turned)
        dx = nearest_image(a.positions[other, 0] - a.positions[row, 0], a.extent[0])
        dy = nearest_image(a.positions[other, 1] - a.positions[row, 1], a.extent[1])
        length = np.sqrt(dx * dx + dy * dy)
        if length > 0.0:
            vx, vy = velocities[row, 0] - velocities[other, 0], velocities[row, 1] - velocities[other, 1]
            closing = vx * (dx / length) + vy * (dy / length)
            out[2, row] = min(max(closing / fastest, -1.0), 1.0)
        out[3, row] = 1.0 if a.cargo[other] != NOTHING else 0.0


@TERMS.register
class CrowdTerm(Term):
    """Robots within each of `neighbour_ranges`, by `full_crowd`, whatever the size of the team."""

    name = "crowd"
    needs = ("neighbours",)

    def __init__(self, observed: Observed, *, neighbour_ranges: Sequence[float], full_crowd: int) -> None:
        super().__init__(observed)
        self.components = tuple(f"crowd_{distance:g}m" for distance in neighbour_ranges)
        self._most = float(full_crowd)

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_shares(self.observed.around.record.within, rows, self._most, out)


@lean_kernel
def write_shares(counts: Ints, rows: Ints, most: float, out: Floats) -> None:
    """Write `counts` (K, R) of `rows` (P,) by `most`, at most 1, into `out` (K, R)."""
    for row in rows:
        for k in range(counts.shape[0]):
            out[k, row] = min(counts[k, row] / most, 1.0)


@TERMS.register
class CarriersTerm(Term):
    """Robots with cargo within the largest neighbour range, by `full_crowd`."""

    name = "carriers"
    needs = ("neighbours",)
    components = ("carriers",)

    def __init__(self, observed: Observed, *, full_crowd: int) -> None:
        super().__init__(observed)
        self._most = float(full_crowd)

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_shares(self.observed.around.record.carriers, rows, self._most, out)


@TERMS.register
class DensityTerm(Term):
    """Share of the torus within 1 m of the robots, if they were far apart."""

    name = "density"
    components = ("density",)

    def __init__(self, observed: Observed) -> None:
        super().__init__(observed)
        self._share = float(np.pi / np.prod(observed.worlds.extent))  # of one robot

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_density(self.observed.around.record.team, rows, self._share, out)


@lean_kernel
def write_density(team: Ints, rows: Ints, share: float, out: Floats) -> None:
    """Write the component of `DensityTerm` into `out` (1, R); team (W,) robots, each of which has a `share`."""
    robots = out.shape[1] // team.shape[0]
    for row in rows:
        out[0, row] = min(team[row // robots] * share, 1.0)
