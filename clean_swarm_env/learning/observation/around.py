"""What is around the robots: the record that the kernels of all observation terms take.

Shapes: W worlds, N robots a world, R = W * N rows, M items a world, K neighbour ranges.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import inlined
from selforg.compiler.records import Recording
from selforg.space import nearest_image


class Around(NamedTuple):
    """Arrays of the worlds, and arrays that `searches` fills. Terms only read them."""

    extent: Annotated[Floats, "2"]  # of the torus [m]
    positions: Annotated[Floats, "R 2"]  # of the robots [m]
    headings: Annotated[Floats, "R"]  # [rad]
    present: Annotated[Flags, "R"]  # whether there is a robot in the row
    cargo: Annotated[Ints, "R"]  # item that the robot carries, NOTHING without one
    recycled: Annotated[Ints, "R"]  # 1 where the cargo has been recycled
    items: Annotated[Floats, "W M 2"]  # places of the items [m]
    stage: Annotated[Ints, "W M"]  # LYING, CARRIED, DONE or ABSENT
    stations: Annotated[Floats, "W 2 2"]  # recycling and dump [m]
    sight: float  # distance within which an item is seen [m]
    longest: float  # half the diagonal of the torus [m]
    ranges: Annotated[Floats, "K"]  # neighbour ranges, growing [m]
    # found for every observation
    team: Annotated[Ints, "W"]  # number of robots present
    item: Annotated[Ints, "R"]  # nearest item in sight, -1 without one
    phases: Annotated[Ints, "R"]  # numbers of `PHASES`
    # found for terms that need "stations"
    station_distances: Annotated[Floats, "2 R"]  # to recycling and dump [m]
    station_ways: Annotated[Floats, "2 3 R"]  # the ways to them, see `write_way`, by `longest`
    # found for terms that need "neighbours"
    neighbour: Annotated[Ints, "R"]  # row of the nearest other robot within the largest range, -1 without one
    within: Annotated[Ints, "K R"]  # number of other robots within each range
    carriers: Annotated[Ints, "1 R"]  # number of other robots with cargo within the largest range


AROUND_RECORD = Recording(Around)
open_around = AROUND_RECORD.open


@inlined
def write_way(around: Around, row: int, place: Floats, scale: float, way: Floats) -> float:
    """Write the way of a row to a place (2,) [m] into column `row` of `way` (3, R); return the distance [m].

    The way is the distance by `scale`, at most 1, then the unit vector to the place in the robot's frame.
    """
    dx = nearest_image(place[0] - around.positions[row, 0], around.extent[0])
    dy = nearest_image(place[1] - around.positions[row, 1], around.extent[1])
    length = float(np.sqrt(dx * dx + dy * dy))
    way[0, row], way[1, row], way[2, row] = min(length / scale, 1.0), 0.0, 0.0
    if length > 0.0:
        cosine, sine = np.cos(around.headings[row]), np.sin(around.headings[row])
        way[1, row] = min(max((cosine * dx + sine * dy) / length, -1.0), 1.0)
        way[2, row] = min(max((cosine * dy - sine * dx) / length, -1.0), 1.0)
    return length
