"""Terms of the whole truth about the others, for comparisons: no robot senses that, or hears it where messages fail.

Why they are in no default: docs/decisions/0214-what-robots-have-heard.md.
"""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.around import Around, write_way
from clean_swarm_env.learning.observation.team_terms import CrowdTerm
from clean_swarm_env.learning.observation.term import TERMS, Term, compiled_term
from clean_swarm_env.tasks.cleaning.garbage import NOTHING
from clean_swarm_env.tasks.cleaning.task import cleaning_of
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.elementary import sine_cosine
from selforg.space import nearest_image


@compiled_term(
    "true_neighbour", "true_neighbours", "true_neighbour_distance", "true_neighbour_ahead", "true_neighbour_left"
)
def write_true_neighbour(around: Around, row: int, out: Floats) -> None:
    """The share of the other robots within the largest neighbour range, and the way to the nearest by that range."""
    last = around.ranges.shape[0] - 1
    out[1] = 1.0
    if around.true_neighbour[row] >= 0:
        out[0] = around.true_within[row, last] / (around.team[row // around.robots] - 1)
        write_way(around, row, around.positions[around.true_neighbour[row]], around.ranges[last], out[1:])


@compiled_term(
    "true_encounter", "true_encounter_ahead", "true_encounter_left", "true_encounter_closing", "true_encounter_carries"
)
def write_true_encounter(around: Around, row: int, out: Floats) -> None:
    """The nearest neighbour: its heading in the robot's frame, how fast it comes closer by twice the largest speed,
    whether it carries something.
    """  # noqa: D205
    other = around.true_neighbour[row]
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
        out[2] = min(max(closing / (2.0 * around.fastest), -1.0), 1.0)


@TERMS.register
class TrueCrowdTerm(CrowdTerm):
    """Robots within each of `neighbour_ranges`, by `full_crowd`, whatever the size of the team."""

    name = "true_crowd"

    @staticmethod
    @inlined
    def write_row(around: Around, row: int, out: Floats) -> None:
        for k in range(around.ranges.shape[0]):
            out[k] = min(around.true_within[row, k] / around.full_crowd, 1.0)


@compiled_term("true_carriers", "true_carriers")
def write_true_carriers(around: Around, row: int, out: Floats) -> None:
    """Robots with cargo within the largest neighbour range, by `full_crowd`."""
    out[0] = min(around.true_carriers[row] / around.full_crowd, 1.0)


@compiled_term("true_density", "true_density")
def write_true_density(around: Around, row: int, out: Floats) -> None:
    """Share of the torus within 1 m of the robots, if they were far apart."""
    out[0] = min(around.team[row // around.robots] * around.area, 1.0)


@compiled_term("true_done", "true_done")
def write_true_done(around: Around, row: int, out: Floats) -> None:
    """Share of the items dumped of those that arrived."""
    world = row // around.robots
    out[0] = around.done[world] / max(around.arrived[world], 1)


@TERMS.register
class TrueSeasonTerm(Term):
    """One flag: garbage comes anywhere now, or about spots."""

    name = "true_season"
    components = ("true_anywhere", "true_spots")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the flags."""
        worlds = self.observed.worlds
        at_spots = np.repeat(cleaning_of(worlds.task).agendas.at_spots, worlds.robots)[rows]
        out[0, rows], out[1, rows] = ~at_spots, at_spots
