"""Terms about the other robots, by the poses that they have received: the nearest one, and how many there are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clean_swarm_env.learning.observation.around import Around, write_offset
from clean_swarm_env.learning.observation.term import AROUND_TERMS, TERMS, CompiledTerm, Observed, Term
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.elementary import sine_cosine
from selforg.mechanisms.steering.base import OTHER_COSINE, OTHER_SINE, OTHER_VX, OTHER_VY, OTHER_X, OTHER_Y


@AROUND_TERMS.term("neighbour", "neighbour_distance", "neighbour_ahead", "neighbour_left")
def write_neighbour(around: Around, row: int, out: Floats) -> None:
    """The way to the nearest other robot that was heard, by the largest neighbour range."""
    out[0] = 1.0
    if around.neighbour[row] >= 0:
        other = around.heard[row]
        write_offset(
            around.headings[row], other[OTHER_X], other[OTHER_Y], around.ranges[around.ranges.shape[0] - 1], out
        )


@AROUND_TERMS.term("encounter", "neighbour_heading_ahead", "neighbour_heading_left", "neighbour_closing")
def write_encounter(around: Around, row: int, out: Floats) -> None:
    """The nearest robot heard: its heading in the robot's frame, how fast it comes closer, by twice the top speed."""
    if around.neighbour[row] < 0:
        return
    other = around.heard[row]
    sine, cosine = sine_cosine(around.headings[row])
    out[0] = cosine * other[OTHER_COSINE] + sine * other[OTHER_SINE]
    out[1] = cosine * other[OTHER_SINE] - sine * other[OTHER_COSINE]
    length = np.sqrt(other[OTHER_X] * other[OTHER_X] + other[OTHER_Y] * other[OTHER_Y])
    if length > 0.0:
        closing = -(other[OTHER_VX] * (other[OTHER_X] / length) + other[OTHER_VY] * (other[OTHER_Y] / length))
        out[2] = min(max(closing / (2.0 * around.fastest), -1.0), 1.0)


@AROUND_TERMS.register
class CrowdTerm(CompiledTerm):
    """Robots heard within each of `neighbour_ranges`, by `full_crowd`, whatever the size of the team."""

    name = "crowd"

    def __init__(self, observed: Observed, *, neighbour_ranges: Sequence[float]) -> None:
        super().__init__(observed)
        self.components = tuple(f"{self.name}_{distance:g}m" for distance in neighbour_ranges)

    @staticmethod
    @inlined
    def write_row(around: Around, row: int, out: Floats) -> None:
        for k in range(around.ranges.shape[0]):
            out[k] = min(around.within[row, k] / around.full_crowd, 1.0)


@TERMS.register
class IdentityTerm(Term):
    """The number of the robot by the most robots of the team, by which equal robots can divide labour."""

    name = "identity"
    components = ("identity",)
    numbers_rows = True

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the numbers."""
        out[0, rows] = rows % self.observed.worlds.robots / self.observed.worlds.robots
