"""What kernels of movements share: the records that they take, and sums of vectors."""

from typing import Annotated, NamedTuple

import numpy as np

from selforg.arrays import Flags, Floats, Ints
from selforg.compiler.decorators import part
from selforg.compiler.records import Recording, Words
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Sight, open_sight
from selforg.randomness import take_direction


class Movements(NamedTuple):
    """The arrays to which a mechanism writes its answers."""

    vectors: Annotated[Floats, "K D"]  # [m/s], zero without a movement
    active: Annotated[Flags, "K"]  # whether there is a movement


class Steering(NamedTuple):
    """A movement rule with its parameters, the random directions of a `DirectionStream`, and room for a sum."""

    combination: int  # this and the next fields: see `MovementRule`
    formula: int
    looks_repulsive: int
    looks_neutral: int
    looks_attractive: int
    wakes_repulsive: int
    wakes_neutral: int
    wakes_attractive: int
    by_own_reach: int
    random: int
    ahead: int
    chooses: int
    see: int  # SEE_ bits
    view_distance: float  # [m]
    min_speed: float  # [m/s]
    max_speed: float  # [m/s]
    angle_xy: float  # view angle to either side of the heading in the x-y plane [rad]
    angle_yz: float  # likewise in the y-z plane
    directions: Annotated[Floats, "N BLOCK 3"]  # unit vectors drawn ahead
    cursor: Annotated[Ints, "N"]  # next direction of each row
    low: Annotated[Flags, "1"]  # set when a row has used half of its directions
    total: Annotated[Floats, "3"]  # room for a sum


MOVEMENTS, STEERING = Recording(Movements), Recording(Steering)
open_movements, open_steering = MOVEMENTS.open, STEERING.open


class Own(NamedTuple):
    """The radii of the row that moves [m]; made in compiled code."""

    goal_radius: float
    reach: float


@part
def add(index: int, length: float, full: float, row: int, sight: Words[Sight], steering: Words[Steering]) -> None:
    """Add a contribution of `length` along the offset of a pair to the sum; -inf becomes `full` [m] away.

    Where the centres coincide there is no offset, and the direction is random.
    """
    if length == 0.0:
        return
    m, pairs = open_steering(steering), open_sight(sight).pairs
    if np.isinf(length):
        length = -full
    distance = pairs[index, c.PAIR_DISTANCE]
    if distance > 0.0:
        scale = length / distance
        m.total[0] += scale * pairs[index, c.PAIR_DX]
        m.total[1] += scale * pairs[index, c.PAIR_DY]
        m.total[2] += scale * pairs[index, c.PAIR_DZ]
    else:
        x, y, z = take_direction(m.directions, m.cursor, m.low, row)
        m.total[0] += abs(length) * x
        m.total[1] += abs(length) * y
        m.total[2] += abs(length) * z


@part
def full_length(index: int, sight: Words[Sight]) -> float:
    """Return the length [m] of full repulsion: the reach of the gradient, 1 where that is infinite (Q2)."""
    pairs = open_sight(sight).pairs
    reach = pairs[index, c.PAIR_DIFFUSION] + pairs[index, c.PAIR_GOAL_RADIUS]
    return reach if np.isfinite(reach) else 1.0


@part
def limit(total: Floats, lowest: float, highest: float) -> None:
    """Bring the length of `total` (3,) into [`lowest`, `highest`] in place; a zero vector stays zero."""
    # components are divided by the largest one first, so that no square overflows
    largest = max(abs(total[0]), abs(total[1]), abs(total[2]))
    if largest == 0.0:
        return
    x, y, z = total[0] / largest, total[1] / largest, total[2] / largest
    unit_length = np.sqrt(x * x + y * y + z * z)
    length = largest * unit_length
    wanted = min(max(length, lowest), highest)
    if wanted != length:
        scale = wanted / unit_length
        total[0], total[1], total[2] = x * scale, y * scale, z * scale
